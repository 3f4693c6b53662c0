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

from workflow.execution.surroundings import short_temporary_folder

LOST = 255  # the status of a fork whose server has ended, by which nobody knows its own
ENDED = "the process that starts the jobs has ended: was it killed, perhaps for want of memory? --cores 1 needs less"
_context = multiprocessing.get_context("forkserver")
_one_at_a_time = Lock()  # to start processes, and to ask for their status


class ServerEndedError(OSError):
    """The process that starts the jobs has ended, so that this one was not started."""


def preload(scripts: Iterable[Path]) -> None:
    """Start the process that loads what scripts import, before the first of them runs.

    Raises:
        ValueError: There is no folder for its socket.
    """
    os.environ["LOADED_SCRIPTS"] = os.pathsep.join(sorted(map(str, scripts)))
    _context.set_forkserver_preload(["workflow.execution.loaded"])
    with short_temporary_folder():
        forkserver.ensure_running()


def run(script: Path, snakemake: object = None) -> int:
    """Run a script in a fork, with what Snakemake gives it.

    Returns:
        Its exit status, or minus the signal that ended it, or `LOST`.

    Raises:
        ServerEndedError: The process that starts the jobs has ended.
    """
    names = {"init_globals": {"snakemake": snakemake}, "run_name": "__main__"}
    process = _context.Process(target=runpy.run_path, args=(str(script),), kwargs=names)
    with _one_at_a_time:
        try:
            process.start()
        except (EOFError, ConnectionError) as error:
            raise ServerEndedError(ENDED) from error
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
