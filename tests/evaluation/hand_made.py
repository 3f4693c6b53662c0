"""Scores written by hand, for tests that know what must come out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pandas as pd

from evaluation.scores import COLUMNS

# (task, method, D, ROW, measure) and its values over the seeds 1, 2, …
Values = Mapping[tuple[str, str, int, int, str], Sequence[float]]


def scores_of(
    values: Values, experiment: str = "simulator", variant: str = "default", dataset: int = 1
) -> pd.DataFrame:
    """The rows of `scores.csv` that hold these values."""
    rows = [
        (experiment, dataset, variant, task, method, "published", D, ROW, seed, measure, value)
        for (task, method, D, ROW, measure), by_seed in values.items()
        for seed, value in enumerate(by_seed, 1)
    ]
    return pd.DataFrame(rows, columns=COLUMNS)
