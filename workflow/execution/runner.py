"""Run a study: keep what is there, take what is in the store, and make the rest."""

from __future__ import annotations

import logging
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Collection, Sequence
from contextlib import suppress
from pathlib import Path

from workflow.artifacts.copies import remove_any
from workflow.artifacts.manifest import records_as_planned, write_manifest
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.records import FOLDER, FULL
from workflow.artifacts.store import Store
from workflow.execution import engine
from workflow.execution.dag import Job, Plan
from workflow.execution.job import time_line, time_of
from workflow.execution.keeping import Keeper
from workflow.execution.progress import Progress
from workflow.execution.surroundings import settle
from workflow.execution.turns import RUNNING, turn_of_run
from workflow.plan.config import keep_config

FAILED, BUSY = 1, 3
LEAST_ROOM = 2**18  # bytes; with less, Snakemake cannot even write its notes
REPORT = "report.html"


def run(config: Path, out: Path, cores: int | None, profile: str, more: Sequence[str], store: Store) -> int:
    """Run what is new in a study, and write the manifest.

    Args:
        config: The config file.
        out: The output folder.
        cores: How many jobs may run at the same time; None for the profile's number.
        profile: Where and how they run, see `engine.command_line`.
        more: Further arguments for Snakemake.
        store: Where artifacts are shared.

    Returns:
        The exit status: 0, 1 if a job failed or was stopped, or 3 if another run is using the folder.
    """
    out = out.resolve()
    _make_folder(out)
    settle(out)
    _show_warnings()
    if _is_full(out):
        return FAILED
    with turn_of_run(out) as alone:
        if not alone:
            sys.stderr.write(f"{out}: another study is running in this folder; wait for it, or name another --out\n")
            return BUSY
        _remove_parts(out)
        config = keep_config(config, out)
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        began = time.monotonic()
        keeper, progress = Keeper(out, store), Progress()
        arguments = [*engine.command_line(config, out, cores, profile), *more]
        status = engine.run(arguments, _hooks(out, keeper, progress))
        progress.end()
        if progress.done:  # what planning, starting and keeping took
            with suppress(OSError):  # the disk may be full
                log = out / "joblogs" / "workflow.log"
                log.write_text(time_line(0.0, time.monotonic() - began, time_of(log)), encoding="utf-8")
        if not keeper.complete:
            status = FAILED
        if status == 0 and keeper.planned:
            try:
                (write_manifest if keeper.whole else records_as_planned)(out, keeper.planned)
            except (ValueError, OSError) as error:
                sys.stderr.write(f"{out}: {error}\n")
                status = FAILED
        store.trim()
        if status == 0 and REPORT in keeper.planned:
            sys.stderr.write(f"look at {out / REPORT}\n")
        elif status != 0:
            _is_full(out)
            sys.stderr.write("stopped; what is done is kept, and the next run goes on with the rest\n")
        return status


def _make_folder(out: Path) -> None:
    """Make the output folder.

    Raises:
        OSError: It cannot be made or written; the message says what helps.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out):
            pass
    except FileExistsError:
        raise NotADirectoryError(f"{out}: is a file, not a folder; name another --out") from None
    except OSError as error:
        if error.errno in FULL:
            return  # which is reported with what helps
        raise OSError(f"{out}: cannot be written ({error.strerror}); name another --out") from error


def _hooks(out: Path, keeper: Keeper, progress: Progress) -> engine.Hooks:
    """The hooks that keep artifacts and show the progress."""

    def decide(plan: Plan) -> Collection[int]:
        needed = keeper.decide(plan)
        if plan.for_real:
            progress.begin(plan.jobs[i].stage for i in needed)
        return needed

    def finished(job: Job, same_code: bool) -> None:
        keeper.finished(job, same_code)
        took = time_of(out / job.log)
        progress.finished(job.stage, took["wall"] if took else 1.0)

    return engine.Hooks(decide, finished)


def _is_full(out: Path) -> bool:
    """Whether the disk of the output folder is full, which is reported."""
    free = shutil.disk_usage(out).free
    if free < LEAST_ROOM:
        sys.stderr.write(
            f"{out}: the disk is full ({free // 1024} KiB are free, {LEAST_ROOM // 1024} KiB are the least); "
            "make room and run again, which goes on from here\n"
        )
    return free < LEAST_ROOM


def _show_warnings() -> None:
    """Show warnings of our own modules, independently of Snakemake's log."""
    logging.raiseExceptions = False  # on a full disk Snakemake would report each line that its log misses
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("%(levelname)s %(message)s"))
    logger = logging.getLogger("workflow")
    logger.addHandler(handler)
    logger.propagate = False


def _remove_parts(out: Path) -> None:
    """Remove what killed runs left under temporary names, but not in studies in subfolders, which may be running."""
    for folder, inner, files in os.walk(out):
        inner[:] = [
            name for name in inner if not any(Path(folder, name, sign).exists() for sign in (FOLDER, RUNNING))
        ]
        for name in [each for each in (*inner, *files) if each.startswith(".") and each.endswith(".part")]:
            remove_any(Path(folder, name))
