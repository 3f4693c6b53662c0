"""Imports what the scripts in the environment variable `LOADED_SCRIPTS` import, so that forks need not."""

import ast
import contextlib
import importlib
import logging
import os
import signal
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

from workflow.artifacts.provenance import imported_files, imported_names

# Arrow's allocator would start a thread, which forks would lack.
os.environ["JE_ARROW_MALLOC_CONF"] = "background_thread:false"
# Left to the jobs: pybullet prints when imported, and importing torchvision may need help.
LATE = ("pybullet", "torchvision")


def load(scripts: list[Path]) -> None:
    """Import all modules that the scripts and their project modules import, even inside functions."""
    files = {file for script in scripts for file in imported_files(script)}
    names = {name for file in files for name in imported_names(ast.parse(file.read_bytes(), str(file)))}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of libraries, about themselves
        for name in sorted(names):
            if not name.startswith(LATE):
                with contextlib.suppress(ImportError):  # a function, or missing, which the job will report
                    importlib.import_module(name)
    if "model.fitting" in names:
        from model.fitting import load_compiled

        with _shown("model.compiled"):
            load_compiled()


@contextlib.contextmanager
def _shown(name: str) -> Iterator[None]:
    """Show on the screen what a module says while the block lasts: compiling takes a minute or two."""
    from workflow.execution.job import CLEAR

    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter(f"{CLEAR if sys.stderr.isatty() else ''}%(message)s, a minute or two"))
    logger = logging.getLogger(name)
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)


# An interrupt ends this process without a word, since the run has one; the forks handle theirs again.
signal.signal(signal.SIGINT, signal.SIG_DFL)
load([Path(script) for script in os.environ["LOADED_SCRIPTS"].split(os.pathsep)])
signal.signal(signal.SIGINT, signal.default_int_handler)
