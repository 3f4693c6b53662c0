"""Jobs as forks of one process that has their libraries loaded.

A new Python per job would spend one to three seconds on imports, for fits that take a quarter of a second. So a run
starts one process (the fork server of `multiprocessing`) that imports what the scripts import. Each job is a fork of
it, which runs one script and ends, so no job sees what another one did. Jobs on a cluster, and those of plain
`snakemake`, start their own Python; the results are the same.
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
_one_at_a_time = Lock()  # to start processes, and to ask for their status


def preload(scripts: Iterable[Path]) -> None:
    """Name the scripts that are going to run, before the first one does."""
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
    """End the process, so that a run leaves nothing behind; the next fork starts a new one."""
    forkserver._forkserver._stop()  # type: ignore[attr-defined]
    resource_tracker._resource_tracker._stop()  # type: ignore[attr-defined]
