"""Tables of means and standard deviations over the data sets or seeds, in every form that people use."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from evaluation.catalogue import Table, cell_name
from evaluation.differences import AXES, differences, readable_differences
from evaluation.measures import CHANCE, chance_note, ranked, shown
from evaluation.replicates import several, statistics
from evaluation.scores import ROW_KEYS, SHARED, in_order, varying
from evaluation.table_forms import Grid, Sheet, number
from model import METHODS

DEFINED = "In brackets n, the number of fits that define the measure, where not all do."
BOLD = "Bold: the highest mean of the methods under the same conditions; means that read alike are both bold."
DIFFERENCE_NOTE = (
    "Differences: mean ± standard deviation, over the same, of the difference of two methods, or of two samplers of "
    "the same method, at the same data set and seed, which omits the same words for both. What differs between "
    "methods is due to the model, as far as its sampler reaches the posterior; what differs between samplers of a "
    "method is due to the sampler alone. With each stands the two-sided p of the exact Wilcoxon signed-rank test, "
    "not corrected for the number of tests."
)


def over(rows: pd.DataFrame) -> str:
    """What stands behind ± in a table of these rows, as its note begins."""
    if several(rows):
        sets = f"the {rows['dataset'].nunique()} data sets, of each data set's mean over its seeds"
    else:
        sets = "the seeds of one data set, which is the same for all of them: it says nothing of other data"
    return f"Mean ± standard deviation (n − 1) over {sets}."


def select(rows: pd.DataFrame, table: Table) -> pd.DataFrame:
    """The scores, or the answers, that a table shows."""
    of_table = (rows.experiment == table.experiment) & rows.task.isin(table.tasks) & ~rows.variant.isin(table.without)
    return rows[of_table if table.D is None else of_table & (rows.D == table.D)]


def summarise(scores: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Mean, standard deviation (n − 1) and number of fits of each measure and condition.

    The mean and its spread are over the data sets, or over the seeds of one data set (`replicates.statistics`).

    Args:
        scores: Rows of `scores.csv` of one experiment.
        measures: Which measures, in this order.

    Returns:
        One row per condition, in the order of `ROW_KEYS`, samplers as the scores have them; columns `ROW_KEYS`,
        `datasets` and `seeds` (how many data sets and seeds have a row), then `{measure}_mean`, `{measure}_sd`,
        `{measure}_n` (the number of fits for which the measure is defined), and `{measure}_chance` where the scores
        tell it. Empty where no fit defines it.
    """
    keys = ROW_KEYS
    chances = [measure + CHANCE for measure in measures if (scores.measure == measure + CHANCE).any()]
    found = statistics(scores[scores.measure.isin([*measures, *chances])], [*keys, "measure"]).reset_index()
    wide = found.pivot_table(index=keys, columns="measure", values=["mean", "sd", "n"], dropna=False)
    wide = wide.dropna(axis=0, how="all")
    result = pd.DataFrame(index=wide.index)
    result["datasets"] = scores.groupby(keys)["dataset"].nunique()
    result["seeds"] = scores.groupby(keys)["seed"].nunique()
    for measure in measures:
        for statistic in ("mean", "sd", "n"):
            column = (statistic, measure)
            result[f"{measure}_{statistic}"] = wide[column] if column in wide.columns else float("nan")
        result[f"{measure}_n"] = result[f"{measure}_n"].fillna(0).astype(int)
        if measure + CHANCE in chances:
            result[measure + CHANCE] = wide[("mean", measure + CHANCE)]
    return in_order(result.reset_index(), keys, sampler=scores["sampler"].unique())


def best(summary: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Which means are the highest of the methods under the same conditions; one column per measure.

    All of them are the better the higher they are. Means that read alike, to three digits, are tied. A method that
    is alone has nobody to be better than.
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
        cells = (summary[f"{measure}_{statistic}"] for statistic in ("mean", "sd", "n"))
        fits = summary["datasets"] * summary["seeds"]
        result[measure] = [_cell(*values) for values in zip(*cells, fits, strict=True)]
        if measure + CHANCE in summary:
            result[f"{measure} by chance"] = [number(value) for value in summary[measure + CHANCE]]
    result["data sets"], result["seeds"] = summary["datasets"], summary["seeds"]
    return result.rename(columns={"ROW": "ROW (%)"})


def _cell(mean: float, sd: float, n: int, fits: int) -> str:
    spread = "" if np.isnan(sd) else f" ± {sd:.3f}"
    return number(mean) + spread + (f" (n = {n})" if 0 < n < fits else "")


def sheet_of_scores(scores: pd.DataFrame, table: Table) -> Sheet:
    """A table of scores, and the differences between its methods and between its samplers, which may have no row.

    Its data are a column per statistic, with `{measure}_best`, and a row per difference.

    Args:
        scores: All scores of the study.
        table: Which of them, and the title.
    """
    chosen = select(scores, table)
    measures = shown(table.tasks, set(chosen.dropna(subset="value")["measure"]))
    compared = ranked(measures)
    summary, paired = summarise(chosen, measures), {axis: differences(chosen, compared, axis) for axis in AXES}
    marks = best(summary, compared)
    conditions = summary[ROW_KEYS].to_dict("records")
    names = pd.DataFrame({measure: [cell_name(one, measure) for one in conditions] for measure in measures})
    return Sheet(
        table.title,
        (
            Grid(table.title, readable(summary, measures), marks, names),
            *(
                Grid(
                    f"{table.title}: differences between {axis}s", readable_differences(paired[axis], compared, axis)
                )
                for axis in AXES
            ),
        ),
        " ".join(filter(None, (over(chosen), DEFINED, BOLD, chance_note(measures), DIFFERENCE_NOTE))),
        {".csv": summary.join(marks.add_suffix("_best")), "_differences.csv": pd.concat(list(paired.values()))},
        table.experiment,
    )
