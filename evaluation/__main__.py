"""Commands on what a study found: compare it with a reference, count what people say of clips, talk to robots.

`python -m evaluation compare results results/reference`
`python -m evaluation ratings FORM.csv … --key KEY.csv`
`python -m evaluation tell results "grasp the red cup"`, `describe results`, `talk results`
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from data_collection.console import run_command
from data_collection.processor import begin_pinned
from evaluation.talk import commands as talk


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, 1 if results differ (by more than seeds explain, or in a verdict), 2 for bad files."""
    parser = argparse.ArgumentParser(prog="python -m evaluation", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    compare = commands.add_parser(
        "compare", help="say which cells differ by more than the seeds explain, and which verdicts"
    )
    compare.add_argument("results", type=Path, help="output folder of a study")
    compare.add_argument("reference", type=Path, help="output folder to compare with")
    ratings = commands.add_parser(
        "ratings", help="the human WAR of each method, from forms that raters have filled in"
    )
    ratings.add_argument("forms", nargs="+", type=Path, metavar="FORM", help="CSV forms, one or more per rater")
    ratings.add_argument("--key", type=Path, required=True, help="which clip shows what: ratings/EXPERIMENT_key.csv")
    ratings.add_argument("--out", type=Path, help="write the rates as CSV, too (default: only print them)")
    talk.add_commands(commands)
    options = parser.parse_args(arguments)
    try:
        if options.command in talk.COMMANDS:
            return talk.run(options)
        return _compare(options) if options.command == "compare" else _ratings(options)
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2


def _compare(options: argparse.Namespace) -> int:
    from evaluation.two_runs import compare_folders

    compared = compare_folders(options.results, options.reference)
    sys.stdout.write(compared.summary())
    if compared.nothing_in_common:
        sys.stderr.write(f"{options.results} and {options.reference} have no cell in common\n")
        return 2
    return 0 if compared.explained and compared.other_verdicts.empty else 1


def _ratings(options: argparse.Namespace) -> int:
    from evaluation.ratings import human_rates, read_forms, read_key
    from evaluation.scores import write_csv

    key = read_key(options.key)
    rates = human_rates(read_forms(options.forms, key), key)
    if options.out is not None:
        write_csv(rates, options.out)
    sys.stdout.write(rates.to_markdown(index=False, floatfmt=".3f") + "\n")
    return 0


if __name__ == "__main__":
    begin_pinned()  # so that robots do what they did in the study
    sys.exit(run_command(main))
