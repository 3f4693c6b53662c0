"""Run a study: one run at a time in an output folder, what is there or in the store is kept, the rest is made."""

from __future__ import annotations

import fcntl
import logging
import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from workflow import dag
from workflow.keeping import Keeper
from workflow.manifest import write_manifest
from workflow.provenance import ROOT
from workflow.store import Store

FAILED, BUSY = 1, 3


def run(config: Path, out: Path, cores: int | None, profile: str, more: Sequence[str], store: Store) -> int:
    """Run what is new of a study, and write its manifest.

    Args:
        config: the config file.
        out: the output folder.
        cores: how many jobs may run at the same time; None for what the profile says.
        profile: where and how they run, see `dag.command_line`.
        more: further arguments for Snakemake.
        store: where artifacts are shared.

    Returns:
        The exit status: 0; 1 where a job failed or was stopped; 3 where another run is on in this folder.
    """
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    _show_warnings()
    with _held(out / ".running") as held:
        if not held:
            sys.stderr.write(f"{out}: another study is running in this folder; wait for it, or name another --out\n")
            return BUSY
        _remove_parts(out)
        os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        keeper = Keeper(out, store)
        arguments = [*dag.command_line(config, out, cores, profile), *more]
        status = dag.run(arguments, dag.Hooks(keeper.decide, keeper.finished))
        if status == 0 and keeper.artifacts is not None:
            try:
                write_manifest(out, keeper.artifacts)
            except ValueError as error:
                sys.stderr.write(f"{error}\n")
                status = FAILED
            store.trim()
        return status


def _show_warnings() -> None:
    """Show what our own modules warn of, apart from what Snakemake logs."""
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("%(levelname)s %(message)s"))
    logger = logging.getLogger("workflow")
    logger.addHandler(handler)
    logger.propagate = False


def _remove_parts(out: Path) -> None:
    """Remove what a killed run was about to write, which carries a temporary name.

    Its last jobs may still live: without their temporary files they fail, rather than write beside the new ones.
    """
    for part in list(out.rglob(".*.part")):
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        else:
            part.unlink(missing_ok=True)


@contextmanager
def _held(path: Path) -> Iterator[bool]:
    """Lock a file for as long as the block lasts, or this process lives; whether nobody else had it."""
    with path.open("a") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
        else:
            yield True
