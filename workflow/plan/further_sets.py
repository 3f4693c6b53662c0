"""How many data sets a study takes next, to decide claims of the paper that are still open."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from evaluation.claims.judging import OPEN
from evaluation.claims.paper import CLAIMS
from workflow.plan.study_config import StudyConfig


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

    Those that the claim that needs fewest is told to need, but at least one more, and at most twice as many.

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


def sets_of(config: Mapping[str, Any]) -> dict[str, int]:
    """Return how many data sets each experiment has that claims are about, and of which more can be simulated.

    Args:
        config: Plain data of a config that was checked.
    """
    claimed = {claim.experiment for claim in CLAIMS}
    experiments = StudyConfig.model_validate(config).experiments
    return {
        name: one.datasets
        for name, one in experiments.items()
        if name in claimed and not {"data", "logs", "features"} & one.model_fields_set
    }


def with_sets(config: Mapping[str, Any], sets: Mapping[str, int]) -> dict[str, Any]:
    """Return a config, plain data, with other numbers of data sets."""
    experiments = config["experiments"]
    changed = {name: {**experiments[name], "datasets": count} for name, count in sets.items()}
    return {**config, "experiments": experiments | changed}
