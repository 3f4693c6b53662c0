"""Further data sets, until every claim of the paper is decided or there are as many as one will pay for."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import yaml

from data_collection.console import counted
from workflow.plan.config import COPY, copied_from, read_config
from workflow.plan.further_sets import Open, more_sets, open_claims, sets_of, with_sets
from workflow.plan.loading import plan

FILE = "claims.csv"
MOST = 1000

RunRound = Callable[[Path, Sequence[str]], int]
"""Runs a config file, of all files or those that are named, and gives the exit status."""


def run_until_decided(config: Path, out: Path, most: int, run_round: RunRound) -> int:
    """Run a study with more and more data sets, and then all of it with the last number of them.

    Each round makes the claims only, and what they rest on; `more_sets` says how many data sets the next one has.

    Args:
        config: The config file; its `datasets` are those of the first round.
        out: The output folder.
        most: So many data sets an experiment may come to have.
        run_round: What runs.

    Returns:
        The exit status: that of the round that failed, or of the whole study.

    Raises:
        ConfigError: The config is wrong, or with so many data sets too large.
        ValueError: `most` is no number of data sets.
    """
    if not 1 <= most <= MOST:
        raise ValueError(f"--until-decided {most}: from 1 to {MOST:,} data sets are expected")
    given = read_config(config)
    sets = sets_of(given)
    largest = {name: max(count, most) for name, count in sets.items()}
    plan(with_sets(given, largest), config)  # what the last round would refuse is told before the first
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, COPY)
        copy.with_suffix(".origin").write_text(str(copied_from(config).resolve()), encoding="utf-8")
        while True:
            text = yaml.safe_dump(with_sets(given, sets), sort_keys=False, allow_unicode=True)
            copy.write_text(text, encoding="utf-8")
            if status := run_round(copy, [FILE]):
                return status
            undecided = open_claims(out / FILE)
            further = more_sets(sets, undecided, most)
            sys.stderr.write(f"{_told(sets, undecided, stays=further == sets)}\n")
            if further == sets:
                return run_round(copy, [])
            sets = further


def _told(sets: Mapping[str, int], undecided: Sequence[Open], *, stays: bool) -> str:
    """Say after a round what is open, and whether more is tried."""
    had = ", ".join(f"{name} {count}" for name, count in sets.items())
    if not undecided:
        return f"data sets: {had}: no claim is open"
    listed = ", ".join(
        f"{one.claim} ({one.experiment}{f', about {one.needed} data sets' if one.needed else ''})"
        for one in undecided
    )
    end = "; there are no further data sets for them" if stays else ""
    return f"data sets: {had}: {counted(len(undecided), 'claim')} open: {listed}{end}"
