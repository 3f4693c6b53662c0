"""Commands on what a study found: `python -m evaluation ratings FORM.csv … --key KEY.csv`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from evaluation.ratings import RatingError, human_rates, read_forms, read_key
from evaluation.scores import write_csv


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 2 when its files cannot be used."""
    parser = argparse.ArgumentParser(prog="python -m evaluation", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    ratings = commands.add_parser(
        "ratings", help="the human WAR of each method, from forms that raters have filled in"
    )
    ratings.add_argument("forms", nargs="+", type=Path, metavar="FORM", help="CSV forms, one or more a rater")
    ratings.add_argument("--key", type=Path, required=True, help="which clip shows what: ratings/EXPERIMENT_key.csv")
    ratings.add_argument("--out", type=Path, help="write the rates as CSV, too")
    return _ratings(parser.parse_args(arguments))


def _ratings(options: argparse.Namespace) -> int:
    try:
        key = read_key(options.key)
        rates = human_rates(read_forms(options.forms, key), key)
    except RatingError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    if options.out is not None:
        write_csv(rates, options.out)
    sys.stdout.write(rates.to_markdown(index=False, floatfmt=".3f") + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
