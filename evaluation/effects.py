"""What differs because of the model, and what because of the sampler: differences over all conditions of a study."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from data_collection.seeding import generator
from evaluation.claims.judging import OPEN
from evaluation.differences import AXES, PAIRS, paired, pairs_of
from evaluation.measures import COMPARED
from evaluation.replicates import bootstrap, units
from evaluation.scores import UNITS

HIGHER, LOWER, EQUAL = "higher", "lower", "equal"
# What one compares, and what is the same on both sides and told with it.
GIVEN = {"method": "sampler", "sampler": "method"}
# Further pairs of methods: C as the authors' program computes it.
METHOD_PAIRS = (*PAIRS, ("mmlda_released", "mmlda"))
COLUMNS = [
    "experiment",
    "compared",
    "side",
    "other",
    "given",
    "measure",
    "mean",
    "low",
    "high",
    "n",
    "datasets",
    "found",
]


def effects(scores: pd.DataFrame) -> pd.DataFrame:
    """Differences between methods for each sampler, and between samplers for each method.

    A difference is first taken in each condition (D, ROW), data set and seed that both sides have, then averaged over
    the conditions of a seed, over the seeds of a data set, and over the data sets. The 95 % interval is that of the
    hierarchical bootstrap (`replicates.bootstrap`).

    Args:
        scores: All rows of `scores.csv`. Of each experiment its first variant counts, which has all conditions.

    Returns:
        Columns `COLUMNS`: `side` − `other` are what is `compared`, `given` is the sampler or method of both; `found`
        is `higher` or `lower` where the interval is above or below zero, `equal` where all fits agree that nothing
        differs, else `not decidable`, as with one seed of one data set; `n` pairs of fits of so many `datasets`.
    """
    rows = []
    for experiment, own in scores[scores.measure.isin(COMPARED)].groupby("experiment", sort=False):
        first = own[own.variant == own.variant.iloc[0]]
        for axis in AXES:
            pairs = METHOD_PAIRS if axis == "method" else pairs_of(first, axis)
            for side, other, differences in paired(first, axis, pairs):
                groups = dict(list(differences.groupby([GIVEN[axis], "measure"])))
                for given, measure in product(first[GIVEN[axis]].unique(), COMPARED):
                    if (given, measure) in groups:
                        names = {"experiment": experiment, "compared": axis, "side": side, "other": other}
                        names |= {"given": given, "measure": measure}
                        rows.append(names | _interval(groups[given, measure].groupby(UNITS).mean(), names))
    return pd.DataFrame(rows, columns=COLUMNS)


def _interval(by_seed: pd.Series[float], names: Mapping[str, Any]) -> dict[str, object]:
    """Mean, interval and what they say of the differences of data sets and seeds; `names` seed the bootstrap."""
    sets = by_seed.index.get_level_values(UNITS[0]).nunique()
    draws = bootstrap([by_seed], generator(0, "effects", *map(str, names.values())))
    low, high = np.quantile(draws, (0.025, 0.975)).round(9)
    found = HIGHER if low > 0 else LOWER if high < 0 else EQUAL if low == high else OPEN
    return {
        "mean": units(by_seed, sets > 1).mean(),
        "low": low,
        "high": high,
        "n": len(by_seed),
        "datasets": sets,
        "found": found if len(by_seed) > 1 else OPEN,
    }
