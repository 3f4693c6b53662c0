"""What means, spreads and intervals are taken over: data sets first, the seeds within them second."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from evaluation.scores import UNITS
from model.data import Floats

RESAMPLES = 10_000
# So many standard errors make half a 95 % interval of a normal distribution.
_HALF = 1.959963984540054


def several(rows: pd.DataFrame) -> bool:
    """Whether rows are of more than one data set, so that these are what a spread is over."""
    return rows["dataset"].nunique() > 1


def units(values: pd.Series[float], over_sets: bool) -> pd.Series[float]:
    """What a mean and its spread are over: the mean of each data set, or of one data set the values of its seeds.

    Args:
        values: The defined values, indexed by `UNITS`.
        over_sets: Whether there are several data sets, see `several`; `values` may still be of one alone.
    """
    return values.groupby(level=UNITS[0]).mean() if over_sets else values


def statistics(rows: pd.DataFrame, keys: Sequence[str]) -> pd.DataFrame:
    """Mean, standard deviation (n − 1) and number of the defined values of each group, by the rule of `units`.

    Args:
        rows: Columns `keys`, `UNITS` and `value`.
        keys: What names a group.

    Returns:
        A row for each group, indexed by `keys`: `mean`, `sd`, and `n`, the number of fits that define the value.
    """
    over_sets = several(rows)
    within = rows.groupby([*keys, UNITS[0]] if over_sets else list(keys), sort=False)["value"]
    found = pd.DataFrame(within.agg(["mean", "std", "count"]).set_axis(["mean", "sd", "n"], axis=1))
    if not over_sets:
        return found
    between = found.groupby(level=list(keys), sort=False)
    return pd.DataFrame({"mean": between["mean"].mean(), "sd": between["mean"].std(), "n": between["n"].sum()})


def bootstrap(parts: Sequence[pd.Series[float]], rng: np.random.Generator) -> Floats:
    """The means of `RESAMPLES` hierarchical bootstrap samples, added up over several parts.

    A sample draws as many data sets as there are, with replacement, and of each as many seeds as it has, with
    replacement, too. All parts have the same data sets drawn, and each has seeds of its own drawn. Of one data set
    only seeds are drawn.

    Args:
        parts: Values indexed by `UNITS`, of the same data sets.
        rng: Draws the samples.

    Returns:
        (RESAMPLES,) sums of the means.
    """
    by_set = [[np.asarray(own, dtype=np.float64) for _, own in part.groupby(level=UNITS[0])] for part in parts]
    count, total = len(by_set[0]), np.zeros(RESAMPLES)
    if count == 1:
        for (values,) in by_set:
            total += values[rng.integers(len(values), size=(RESAMPLES, len(values)))].mean(axis=1)
        return total
    for _ in range(count):
        drawn = rng.integers(count, size=RESAMPLES)
        for sets in by_set:
            total += _means_of_seeds(sets, drawn, rng) / count
    return total


def _means_of_seeds(sets: Sequence[Floats], drawn: np.ndarray, rng: np.random.Generator) -> Floats:
    """For each drawn data set (RESAMPLES,) the mean of as many of its seeds as it has, drawn with replacement."""
    sizes = np.array([len(values) for values in sets])
    table = np.zeros((len(sets), sizes.max()))
    for row, values in zip(table, sets, strict=True):
        row[: len(values)] = values
    size = sizes[drawn][:, np.newaxis]
    seeds = (rng.random((len(drawn), table.shape[1])) * size).astype(np.int64)
    counted = np.arange(table.shape[1]) < size
    return np.asarray((table[drawn[:, np.newaxis], seeds] * counted).sum(axis=1) / size[:, 0])


def sets_needed(differences: Floats, distance: float) -> float:
    """About how many data sets would set the mean of a difference apart from a bound, if their spread stays as it is.

    So many that half the 95 % interval of the mean, 1.96 standard deviations by the root of their number, is no more
    than the distance.

    Args:
        differences: (n,) the mean difference of each data set so far.
        distance: How far their mean is from the bound.

    Returns:
        A whole number, at least one more than there are; infinite at the bound itself, NaN of one data set alone.
    """
    if len(differences) < 2:
        return float("nan")
    with np.errstate(divide="ignore"):
        needed = np.ceil((_HALF * differences.std(ddof=1) / np.float64(distance)) ** 2)
    return float(max(needed, len(differences) + 1))
