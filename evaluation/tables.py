"""Tables of means and standard deviations over the seeds, in every form that people use."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from evaluation.catalogue import Table, cell_name
from evaluation.differences import differences, readable_differences
from evaluation.measures import CHANCE, chance_note, shown
from evaluation.scores import ROW_KEYS, SHARED, in_order, varying
from evaluation.table_forms import Grid, Sheet
from model import METHODS

NOTE = (
    "Mean ± standard deviation (n − 1) over the seeds; n is given where not every seed defines the measure. The data "
    "are the same for all seeds. Bold: the highest mean of the methods under the same conditions; means that read "
    "alike are both bold."
)
DIFFERENCE_NOTE = (
    "Differences: mean ± standard deviation over the seeds of the difference of two methods at the same seed, which "
    "omits the same words for both, and the two-sided p of the exact Wilcoxon signed-rank test, not corrected for "
    "the number of tests."
)


def select(scores: pd.DataFrame, table: Table) -> pd.DataFrame:
    """The scores that a table shows."""
    of_table = (scores.experiment == table.experiment) & scores.task.isin(table.tasks)
    of_table &= ~scores.variant.isin(table.without)
    return scores[of_table if table.D is None else of_table & (scores.D == table.D)]


def summarise(scores: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Mean, standard deviation (n − 1) and number of seeds of each measure and condition.

    Args:
        scores: Rows of `scores.csv` of one experiment.
        measures: Which measures, in this order.

    Returns:
        One row per condition, in the order ROW, then method as in `METHODS`; columns `ROW_KEYS`, `seeds` (the
        number of seeds with a row), then `{measure}_mean`, `{measure}_sd`, `{measure}_n` (the number of
        seeds for which the measure is defined), and `{measure}_chance` where the scores tell it. Empty where no
        seed defines it.
    """
    keys = ROW_KEYS
    chances = [measure + CHANCE for measure in measures if (scores.measure == measure + CHANCE).any()]
    grouped = scores[scores.measure.isin([*measures, *chances])].groupby([*keys, "measure"], sort=False)["value"]
    statistics = grouped.agg(mean="mean", sd="std", n="count").reset_index()
    wide = statistics.pivot_table(index=keys, columns="measure", values=["mean", "sd", "n"], dropna=False)
    wide = wide.dropna(axis=0, how="all")
    result = pd.DataFrame(index=wide.index)
    result["seeds"] = scores.groupby(keys)["seed"].nunique()
    for measure in measures:
        for statistic in ("mean", "sd", "n"):
            column = (statistic, measure)
            result[f"{measure}_{statistic}"] = wide[column] if column in wide.columns else float("nan")
        result[f"{measure}_n"] = result[f"{measure}_n"].fillna(0).astype(int)
        if measure + CHANCE in chances:
            result[measure + CHANCE] = wide[("mean", measure + CHANCE)]
    return in_order(result.reset_index(), keys)


def best(summary: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Which means are the highest of the methods under the same conditions; one column per measure.

    All measures are better the higher they are. Means that read alike, to three digits, are tied. A method that is
    alone has nobody to be better than.
    """
    groups = [summary[key] for key in SHARED]
    marks = {}
    for measure in measures:
        means = summary[f"{measure}_mean"].round(3)
        compared = means.groupby(groups)
        marks[measure] = (means == compared.transform("max")) & (compared.transform("count") > 1)
    return pd.DataFrame(marks)


def readable(summary: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """The summary as people read it: `mean ± sd`, a dash where undefined, keys that never change left out."""
    result = summary[varying(summary, ROW_KEYS, "ROW", "method")].copy()
    result["method"] = [METHODS[name].label for name in summary["method"]]
    for measure in measures:
        statistics = (summary[f"{measure}_{statistic}"] for statistic in ("mean", "sd", "n"))
        result[measure] = [_cell(*values) for values in zip(*statistics, summary["seeds"], strict=True)]
        if measure + CHANCE in summary:
            result[f"{measure} by chance"] = [_mean(value) for value in summary[measure + CHANCE]]
    result["seeds"] = summary["seeds"]
    return result.rename(columns={"ROW": "ROW (%)"})


def _mean(mean: float) -> str:
    return "–" if np.isnan(mean) else f"{mean:.3f}"


def _cell(mean: float, sd: float, n: int, seeds: int) -> str:
    spread = "" if np.isnan(sd) else f" ± {sd:.3f}"
    return _mean(mean) + spread + (f" (n = {n})" if 0 < n < seeds else "")


def sheet_of_scores(scores: pd.DataFrame, table: Table) -> Sheet:
    """A table of scores, and the differences between its methods, which may have no row.

    Its data are a column per statistic, with `{measure}_best`, and a row per difference.

    Args:
        scores: All scores of the study.
        table: Which of them, and the title.
    """
    chosen, measures = select(scores, table), shown(table.tasks)
    summary, paired = summarise(chosen, measures), differences(chosen, measures)
    marks = best(summary, measures)
    conditions = summary[ROW_KEYS].to_dict("records")
    names = pd.DataFrame({measure: [cell_name(one, measure) for one in conditions] for measure in measures})
    return Sheet(
        table.title,
        (
            Grid(table.title, readable(summary, measures), marks, names),
            Grid(f"{table.title}: differences between methods", readable_differences(paired, measures)),
        ),
        " ".join(filter(None, (NOTE, chance_note(measures), DIFFERENCE_NOTE))),
        {".csv": summary.join(marks.add_suffix("_best")), "_differences.csv": paired},
    )
