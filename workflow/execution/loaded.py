"""Importing this module imports what jobs' scripts import, so that forks of the process need not.

The scripts are those that the environment variable `LOADED_SCRIPTS` names.
"""

import ast
import contextlib
import importlib
import os
import warnings
from pathlib import Path

from workflow.artifacts.provenance import imported_files, imported_names

# Arrow's allocator would start a thread, which no fork would have.
os.environ["JE_ARROW_MALLOC_CONF"] = "background_thread:false"
# Left to the job: pybullet prints when it is imported, torchvision may need help to be.
LATE = ("pybullet", "torchvision")


def load(scripts: list[Path]) -> None:
    """Import every module that scripts import, and those that functions of the project import when called."""
    files = {file for script in scripts for file in imported_files(script)}
    names = {name for file in files for name in imported_names(ast.parse(file.read_bytes(), str(file)))}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what libraries say of themselves when they are imported
        for name in sorted(names):
            if not name.startswith(LATE):
                with contextlib.suppress(ImportError):  # a function of a module is none; a job says what is missing
                    importlib.import_module(name)
    if "model.fitting" in names:
        from model.fitting import load_compiled

        load_compiled()


try:
    load([Path(script) for script in os.environ["LOADED_SCRIPTS"].split(os.pathsep)])
except KeyboardInterrupt:  # the run says that it was stopped
    raise SystemExit(1) from None
