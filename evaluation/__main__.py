"""Compare a study with a reference: `python -m evaluation compare results results/reference`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from evaluation.compare import compare_folders


def main() -> int:
    """Print what differs; 0 if the seeds explain all of it, 1 if not, 2 if there is nothing to compare."""
    parser = argparse.ArgumentParser(prog="python -m evaluation", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    compare = commands.add_parser("compare", help="say which cells differ by more than the seeds explain")
    compare.add_argument("results", type=Path, help="output folder of a study")
    compare.add_argument("reference", type=Path, help="output folder to compare with")
    arguments = parser.parse_args()
    try:
        compared = compare_folders(arguments.results, arguments.reference)
    except (FileNotFoundError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    sys.stdout.write(compared.summary())
    if compared.nothing_in_common:
        sys.stderr.write(f"{arguments.results} and {arguments.reference} have no cell in common\n")
        return 2
    return 0 if compared.explained else 1


if __name__ == "__main__":
    sys.exit(main())
