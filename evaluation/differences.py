"""Differences between methods, in pairs of fits that share a seed and with it the omitted words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from scipy.stats import rankdata

from evaluation.scores import SHARED, varying
from model import METHODS
from model.data import Floats

# The differences that tables show: A − B and A − C.
PAIRS = (("proposed", "no_mec2"), ("proposed", "mmlda"))
COLUMNS = (*SHARED, "method", "other", "measure", "mean", "sd", "n", "p")


def letter(method: str) -> str:
    """What the paper's text calls a method: A, B, C or ALL."""
    label = METHODS[method].label
    return label[1] if label.startswith("(") else label


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


def differences(scores: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """The differences of `PAIRS` over the seeds that both methods have.

    Args:
        scores: Rows of `scores.csv` of one experiment.
        measures: Which measures, in this order.

    Returns:
        One row for each condition, pair and measure that some seed defines for both methods; columns `COLUMNS`:
        `mean` and `sd` (n − 1) of method − other over the `n` seeds, and `p` (`signed_rank_p`).
    """
    wanted = scores[scores.measure.isin(measures)]
    by_method = wanted.pivot(index=[*SHARED, "measure", "seed"], columns="method", values="value")
    rows = []
    for method, other in PAIRS:
        if not {method, other} <= set(by_method.columns):
            continue
        paired = (by_method[method] - by_method[other]).dropna()
        for names, group in paired.groupby([*SHARED, "measure"]):
            *shared, measure = names
            values = group.to_numpy()
            sd = values.std(ddof=1) if len(values) > 1 else float("nan")
            rows.append((*shared, method, other, measure, values.mean(), sd, len(values), signed_rank_p(values)))
    result = pd.DataFrame(rows, columns=list(COLUMNS))
    order = [*(other for _, other in PAIRS), *measures]
    return result.sort_values(
        [*SHARED, "other", "measure"],
        key=lambda own: own.map(order.index) if own.name in ("other", "measure") else own,
        ignore_index=True,
    )


def readable_differences(found: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """The differences as people read them: a row per pair, a column per measure, `mean ± sd (p)`."""
    shown = varying(found, SHARED, "ROW")
    keys = [*SHARED, "method", "other"]
    most = found["n"].max() if len(found) else 0
    text = [_cell(*values, most) for values in zip(found["mean"], found["sd"], found["n"], found["p"], strict=True)]
    wide = found[keys].assign(measure=found["measure"], text=text)
    wide = (
        wide.pivot(index=keys, columns="measure", values="text")
        .reindex(columns=list(measures))
        .astype(object)
        .fillna("–")
    )
    rows = found[keys].drop_duplicates().join(wide, on=keys)
    pairs = zip(rows["method"], rows["other"], strict=True)
    rows["difference"] = [f"{letter(method)} − {letter(other)}" for method, other in pairs]
    return rows[[*shown, "difference", *measures]].rename(columns={"ROW": "ROW (%)"}).reset_index(drop=True)


def _cell(mean: float, sd: float, n: int, p: float, most: int) -> str:
    spread = "" if np.isnan(sd) else f" ± {sd:.3f}"
    chance = "p < 0.001" if p < 0.0005 else f"p = {p:.3f}"
    return f"{signed(mean)}{spread} ({chance}{'' if n == most else f', n = {n}'})"
