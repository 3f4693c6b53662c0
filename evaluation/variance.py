"""How much of what fits differ in is due to their data set, and how much to their seed."""

from __future__ import annotations

import numpy as np
import pandas as pd

from evaluation.measures import COMPARED
from evaluation.scores import ROW_KEYS, UNITS, in_order

KEYS = ["experiment", *ROW_KEYS, "measure"]
COLUMNS = [*KEYS, "mean", "between", "within", "share_between", "datasets", "seeds"]


def variance_split(scores: pd.DataFrame) -> pd.DataFrame:
    """The variance of each measure and condition in two parts, by a one-way analysis of variance (random effects).

    A value is the sum of a mean, of what is the data set's, and of what is the seed's. The variance within data sets,
    over the seeds, is the mean square within them. That between data sets is what the variance of their means has
    beyond what their seeds give it, the variance within by the number of seeds; it is 0 where that leaves nothing.

    Args:
        scores: All rows of `scores.csv`. Data sets of which only some seeds define a measure count with these.

    Returns:
        Columns `COLUMNS`: a row for each condition and measure that some fit defines. `mean` is over data sets and
        the seeds within them, `between` and `within` are standard deviations, `share_between` is the share of the
        data sets in the sum of both variances; NaN where one data set, or one seed, leaves a part unknown, and where
        nothing varies. `seeds` is the mean number of seeds of a data set.
    """
    known = scores[scores.measure.isin(COMPARED)].dropna(subset=["value"])
    by_set = known.groupby([*KEYS, UNITS[0]])["value"].agg(["mean", "var", "count"]).reset_index(level=UNITS[0])
    rows = [
        dict(zip(KEYS, names, strict=True)) | _split(own)
        for names, own in by_set.groupby(level=KEYS)
        if isinstance(names, tuple)
    ]
    found = pd.DataFrame(rows, columns=COLUMNS)
    experiments, samplers = (scores[key].unique() for key in ("experiment", "sampler"))
    return in_order(found, KEYS, experiment=experiments, sampler=samplers, measure=COMPARED)


def pooled(split: pd.DataFrame) -> pd.DataFrame:
    """The two parts of each measure, of all conditions of an experiment, sampler and method: their variances' means.

    Args:
        split: What `variance_split` gives. Conditions in which a part is unknown are left out.

    Returns:
        Columns `experiment`, `sampler`, `method`, `measure`, `between`, `within` (standard deviations) and
        `share_between`.
    """
    keys = ["experiment", "sampler", "method", "measure"]
    known = split.dropna(subset=["between", "within"])
    squares = known.assign(between=known["between"] ** 2, within=known["within"] ** 2)
    means = squares.groupby(keys, sort=False)[["between", "within"]].mean()
    total = means.sum(axis=1)
    share = (means["between"] / total).where(total > 0)
    deviations: pd.DataFrame = means**0.5
    return deviations.assign(share_between=share).reset_index()


def _split(by_set: pd.DataFrame) -> dict[str, float]:
    """The parts of one condition and measure, of a row with `mean`, `var` and `count` for each data set."""
    sizes, sets = by_set["count"].to_numpy(dtype=np.float64), len(by_set)
    free = sizes.sum() - sets
    within = float("nan") if free == 0 else float((by_set["var"].fillna(0.0) * (sizes - 1)).sum() / free)
    between = float("nan")
    if sets > 1:
        # Data sets of unequal size: the seeds' part of the variance of means is that of their harmonic mean.
        between = max(float(by_set["mean"].var(ddof=1)) - within * float(np.mean(1 / sizes)), 0.0)
    total = between + within
    return {
        "mean": float(by_set["mean"].mean()),
        "between": float(np.sqrt(between)),
        "within": float(np.sqrt(within)),
        "share_between": between / total if total > 0 else float("nan"),
        "datasets": sets,
        "seeds": float(sizes.mean()),
    }
