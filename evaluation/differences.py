"""Differences between methods, and between samplers, in pairs of fits of one data set and seed, so of the same words.

The first say what is due to the model, the second what is due to how its posterior is sampled.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import pandas as pd
from scipy.stats import rankdata

from evaluation.replicates import several, units
from evaluation.scores import ROW_KEYS, UNITS, in_order, varying
from evaluation.table_forms import by_measure
from model import METHODS
from model.data import Floats

# The differences between methods that tables show: A − B and A − C.
PAIRS = (("proposed", "no_mec2"), ("proposed", "mmlda"))
# What is compared, and what is the same for both sides then.
AXES = {axis: [key for key in ROW_KEYS if key != axis] for axis in ("method", "sampler")}
COLUMNS = (*ROW_KEYS, "compared", "other", "measure", "mean", "sd", "n", "datasets", "p")


def pairs_of(scores: pd.DataFrame, axis: str) -> Sequence[tuple[str, str]]:
    """The pairs that are compared: `PAIRS` of methods, or each further sampler with the first of the scores."""
    if axis == "method":
        return PAIRS
    first, *others = scores[axis].unique() if len(scores) else [""]
    return [(other, first) for other in others]


def paired(
    scores: pd.DataFrame, axis: str, pairs: Iterable[tuple[str, str]]
) -> Iterator[tuple[str, str, pd.Series[float]]]:
    """Those pairs of an axis that were run, with their differences by condition, measure, data set and seed."""
    by_side = scores.pivot(index=[*AXES[axis], "measure", *UNITS], columns=axis, values="value")
    for side, other in pairs:
        if {side, other} <= set(by_side.columns):
            yield side, other, (by_side[side] - by_side[other]).dropna()


def letter(method: str) -> str:
    """What the paper's text calls a method: A, B, C or ALL; with `released` what the authors' program computes."""
    label = METHODS[method].label
    name = label[1] if label.startswith("(") else label
    return name if METHODS[method].is_model else f"{name} released"


def signed(value: float) -> str:
    """A difference as people read it: with its sign, three digits, a dash where it is not known."""
    return "–" if np.isnan(value) else f"{value:+.3f}".replace("-", "−")


def signed_rank_p(values: Floats) -> float:
    """The two-sided p of Wilcoxon's signed-rank test, exact for any number of ties (Wilcoxon 1945).

    Chosen over the paired t because shares of twelve instructions or of a few words, near 1, are not normal; with
    ten seeds its exact distribution is at hand. Values of zero say nothing about a direction and are left out; where
    all are zero there is no difference to find, and p = 1.

    Args:
        values: (n,) differences. Values that differ by rounding alone (1e-12) are tied.

    Returns:
        p, NaN without values.
    """
    if not len(values):
        return float("nan")
    rounded = np.round(values, 12)
    rounded = rounded[rounded != 0]
    ranks = np.rint(2 * rankdata(np.abs(rounded))).astype(np.int64)  # twice the ranks: ties have halves
    probability = np.ones(1)  # of each sum of the ranks with a plus sign, every sign being as likely as the other
    for rank in ranks:
        probability = (np.pad(probability, (0, rank)) + np.pad(probability, (rank, 0))) / 2
    plus = int(ranks[rounded > 0].sum())
    return float(min(1.0, 2 * min(probability[: plus + 1].sum(), probability[plus:].sum())))


def differences(scores: pd.DataFrame, measures: Sequence[str], axis: str = "method") -> pd.DataFrame:
    """The differences of `pairs_of` over the data sets, or over the seeds of one, that both sides have.

    Args:
        scores: Rows of `scores.csv` of one experiment.
        measures: Which measures, in this order.
        axis: What is compared: `method`, or `sampler` for the same method.

    Returns:
        One row for each condition, pair and measure that some seed defines for both sides; columns `COLUMNS`:
        `mean` and `sd` (n − 1) of the condition's value minus that with `other` in the column that `compared` names,
        by the rule of `replicates.units`, over `n` pairs of fits of so many `datasets`, and `p` (`signed_rank_p`).
    """
    shared, rows = AXES[axis], []
    for side, other, values_of_pair in paired(scores[scores.measure.isin(measures)], axis, pairs_of(scores, axis)):
        for names, group in values_of_pair.groupby([*shared, "measure"]):
            values = np.asarray(units(group, several(scores)), dtype=np.float64)
            sd = values.std(ddof=1) if len(values) > 1 else float("nan")
            counts = {"n": len(group), "datasets": group.index.get_level_values(UNITS[0]).nunique()}
            statistics = {"mean": values.mean(), "sd": sd, **counts, "p": signed_rank_p(values)}
            condition = dict(zip([*shared, "measure"], names, strict=True)) | {axis: side}
            rows.append(condition | {"compared": axis, "other": other} | statistics)
    result = pd.DataFrame(rows, columns=list(COLUMNS))
    samplers = scores["sampler"].unique()
    others = samplers if axis == "sampler" else tuple(METHODS)
    return in_order(result, [*shared, axis, "other", "measure"], sampler=samplers, other=others, measure=measures)


def readable_differences(found: pd.DataFrame, measures: Sequence[str], axis: str = "method") -> pd.DataFrame:
    """The differences as people read them: a row per pair, a column per measure, `mean ± sd (p)`."""
    shown = varying(found, AXES[axis], "ROW", *(["method"] if axis == "sampler" else []))
    keys = [*ROW_KEYS, "other"]
    most = found["n"].max() if len(found) else 0
    text = [_cell(*values, most) for values in zip(found["mean"], found["sd"], found["n"], found["p"], strict=True)]
    rows = by_measure(found, keys, text, measures)
    names = letter if axis == "method" else str
    pairs = zip(rows[axis], rows["other"], strict=True)
    rows["difference"] = [f"{names(side)} − {names(other)}" for side, other in pairs]
    if axis == "sampler":
        rows["method"] = [METHODS[name].label for name in rows["method"]]
    return rows[[*shown, "difference", *measures]].rename(columns={"ROW": "ROW (%)"})


def _cell(mean: float, sd: float, n: int, p: float, most: int) -> str:
    spread = "" if np.isnan(sd) else f" ± {sd:.3f}"
    chance = "p < 0.001" if p < 0.0005 else f"p = {p:.3f}"
    return f"{signed(mean)}{spread} ({chance}{'' if n == most else f', n = {n}'})"
