"""Run a study and look at what it made: `python -m workflow run --config config/config.yaml --out results`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from data_collection.console import run_command

STOPPED = 1


def main() -> int:
    """Run the command line, whose modules are imported here, so that an interrupt meanwhile has its message, too."""
    leave_out_foreign_packages()
    return run_command(_command_line, STOPPED)


def _command_line() -> int:
    from workflow.command_line import main as command_line

    return command_line()


def leave_out_foreign_packages() -> None:
    """Take the folders in PYTHONPATH from where this process, and those that it starts, import from.

    What ROS or a cluster's modules put there may be made for another Python, would come before the packages of
    `environment.lock`, and is part of no key.
    """
    own = Path(__file__).resolve().parents[1]
    foreign = {Path(each).resolve() for each in os.environ.pop("PYTHONPATH", "").split(os.pathsep) if each} - {own}
    if foreign:
        sys.path[:] = [str(own), *(each for each in sys.path if Path(each).resolve() not in foreign)]


if __name__ == "__main__":
    sys.exit(main())
