"""Jobs as forks of one process that has their libraries loaded.

A new Python for each job would spend one to three seconds on imports, for fits of a quarter of a second. So a run
starts one process (`multiprocessing`'s fork server) that imports what the scripts of its jobs import; each job is
a fork of it, which runs its script and ends. No job sees what another one did. Jobs that Snakemake runs elsewhere,
on a cluster or without `python -m workflow run`, start a Python each, to the same effect.
"""

from __future__ import annotations

import multiprocessing
import os
import runpy
from collections.abc import Iterable
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import wait
from pathlib import Path
from threading import Lock

_context = multiprocessing.get_context("forkserver")
_one_at_a_time = Lock()  # Processes are started and asked for their status by one thread at a time


def preload(scripts: Iterable[Path]) -> None:
    """Say which scripts are going to run, before the first does."""
    os.environ["LOADED_SCRIPTS"] = os.pathsep.join(sorted(map(str, scripts)))
    _context.set_forkserver_preload(["workflow.execution.loaded"])


def run(script: Path, snakemake: object = None) -> int:
    """Run a script in a fork, with what Snakemake gives it; its exit status, or minus the signal that ended it."""
    names = {"init_globals": {"snakemake": snakemake}, "run_name": "__main__"}
    process = _context.Process(target=runpy.run_path, args=(str(script),), kwargs=names)
    with _one_at_a_time:
        process.start()
    wait([process.sentinel])
    with _one_at_a_time:
        process.join()
    status = process.exitcode
    process.close()
    return 1 if status is None else status


def stop() -> None:
    """End the process, so that a run leaves nothing behind it; the next fork starts another."""
    forkserver._forkserver._stop()  # type: ignore[attr-defined]
    resource_tracker._resource_tracker._stop()  # type: ignore[attr-defined]
