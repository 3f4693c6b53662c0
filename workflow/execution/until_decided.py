"""Further data sets, until every claim of the paper is decided or there are as many as one will pay for."""

from __future__ import annotations

import csv
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from data_collection.console import counted
from data_collection.files import write_text
from evaluation.claims.judging import OPEN
from evaluation.claims.paper import CLAIMS
from workflow.plan.config import COPY, copied_from, read_config
from workflow.plan.loading import plan
from workflow.plan.study_config import StudyConfig

FILE = "claims.csv"
MOST = 1000


class Open(NamedTuple):
    """A claim that is not decided.

    Attributes:
        claim: Its number.
        experiment: What it is about.
        needed: About so many data sets would decide it; None where that is not known.
    """

    claim: str
    experiment: str
    needed: int | None


RunRound = Callable[[Path, Sequence[str]], int]
"""Runs a config file, of all files or those that are named, and gives the exit status."""


def run_until_decided(config: Path, out: Path, most: int, run_round: RunRound) -> int:
    """Run a study with more and more data sets, and then all of it with the last number of them.

    Each round makes the claims only, and what they rest on. An experiment with an open claim has as many data sets in
    the next one as the claim that needs fewest is told to need, but at most twice as many as before.

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
    sets = _datasets(given)
    largest = {name: max(count, most) for name, count in sets.items()}
    plan(_with_datasets(given, largest), config)  # what the last round would refuse is told before the first
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, COPY)
        write_text(copy.with_suffix(".origin"), str(copied_from(config).resolve()))
        while True:
            write_text(copy, yaml.safe_dump(_with_datasets(given, sets), sort_keys=False, allow_unicode=True))
            if status := run_round(copy, [FILE]):
                return status
            undecided = open_claims(out / FILE)
            further = more_sets(sets, undecided, most)
            sys.stderr.write(f"{_told(sets, undecided, stays=further == sets)}\n")
            if further == sets:
                return run_round(copy, [])
            sets = further


def open_claims(path: Path) -> list[Open]:
    """Read which claims of a study are not decided.

    Args:
        path: Its `claims.csv`.
    """
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return [
        Open(row["claim"], row["experiment"], int(row["needed"]) if row["needed"].isdigit() else None)
        for row in rows
        if row["verdict"] == OPEN
    ]


def more_sets(sets: Mapping[str, int], undecided: Sequence[Open], most: int) -> dict[str, int]:
    """Return how many data sets each experiment has in the next round; the same if there is no further one.

    Args:
        sets: Those of this round, by experiment; an experiment that is left out cannot have more.
        undecided: What they leave open.
        most: No experiment gets more than so many.
    """
    own = {name: [one for one in undecided if one.experiment == name] for name in sets}
    return {name: _next(count, own[name], most) for name, count in sets.items()}


def _next(count: int, undecided: Sequence[Open], most: int) -> int:
    if not undecided or count >= most:
        return count
    wanted = min(one.needed or 2 * count for one in undecided)
    return min(max(wanted, count + 1), 2 * count, most)


def _datasets(config: Mapping[str, Any]) -> dict[str, int]:
    """How many data sets each experiment has that claims are about, and of which more can be simulated."""
    claimed = {claim.experiment for claim in CLAIMS}
    experiments = StudyConfig.model_validate(config).experiments
    return {
        name: one.datasets
        for name, one in experiments.items()
        if name in claimed and not {"data", "logs", "features"} & one.model_fields_set
    }


def _with_datasets(config: Mapping[str, Any], sets: Mapping[str, int]) -> dict[str, Any]:
    """Return a config with other numbers of data sets."""
    experiments = config["experiments"]
    changed = {name: {**experiments[name], "datasets": count} for name, count in sets.items()}
    return {**config, "experiments": experiments | changed}


def _told(sets: Mapping[str, int], undecided: Sequence[Open], *, stays: bool) -> str:
    """Say after a round what is open, and what comes next."""
    had = ", ".join(f"{name} {count}" for name, count in sets.items())
    if not undecided:
        return f"data sets: {had}: no claim is open"
    listed = ", ".join(
        f"{one.claim} ({one.experiment}{f', about {one.needed} data sets' if one.needed else ''})"
        for one in undecided
    )
    end = "; there are no further data sets for them" if stays else ""
    return f"data sets: {had}: {counted(len(undecided), 'claim')} open: {listed}{end}"
