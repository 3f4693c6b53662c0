"""Tables of means and standard deviations over the seeds, in every form that people use."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from data_collection.files import replacing
from evaluation.catalogue import Table, cell_name
from evaluation.differences import SHARED, differences, readable_differences
from evaluation.table_forms import Grid, text_forms
from model import METHODS

# What tells one row of a table from another, most general first; a key with one value is left out.
ROW_KEYS = (*SHARED, "method")
# A measure of this name beside another is what chance would give.
CHANCE = "_chance"

NOTE = (
    "Mean ± standard deviation (n − 1) over the seeds; n is given where not every seed defines the measure. The data "
    "are the same for all seeds. Bold: the highest mean of the methods under the same conditions; means that read "
    "alike are both bold."
)
CHANCE_NOTE = (
    "Chance: of OAR, an object at random (the mean of 1 / number of objects over the instructions); of WAR, an "
    "action that the tutor calls by each action word equally often (1 / number of action words); of ACC, a word of "
    "the right channel at random (the mean of 1 / number of words of the channel over the words to say)."
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
        scores: rows of `scores.csv` of one experiment.
        measures: which measures, in this order.

    Returns:
        One row a condition, in the order ROW, then method as in `METHODS`; columns `ROW_KEYS`, `seeds` (the
        number of seeds with a row), then `{measure}_mean`, `{measure}_sd`, `{measure}_n` (the number of
        seeds for which the measure is defined), and `{measure}_chance` where the scores tell it. Empty where no
        seed defines it.
    """
    keys = list(ROW_KEYS)
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
    order = {name: i for i, name in enumerate(METHODS)}
    result = result.reset_index()
    place = result["method"].map(order)
    return result.assign(place=place).sort_values([*keys[:-1], "place"]).drop(columns="place").reset_index(drop=True)


def best(summary: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Which means are the highest of the methods under the same conditions; one column a measure.

    All measures are better the higher they are. Means that read alike, to three digits, are tied. A method that is
    alone has nobody to be better than.
    """
    groups = [summary[key] for key in SHARED]
    marks = {}
    for measure in measures:
        shown = summary[f"{measure}_mean"].round(3)
        compared = shown.groupby(groups)
        marks[measure] = (shown == compared.transform("max")) & (compared.transform("count") > 1)
    return pd.DataFrame(marks)


def readable(summary: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """The summary as people read it: `mean ± sd`, a dash where undefined, keys that never change left out."""
    shown = [key for key in ROW_KEYS if key in ("ROW", "method") or summary[key].nunique() > 1]
    result = summary[shown].copy()
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


def grids(summary: pd.DataFrame, paired: pd.DataFrame, table: Table) -> tuple[Grid, Grid]:
    """A table, and the differences between its methods, as people read them; the latter may have no row.

    Args:
        summary: what `summarise` gives.
        paired: what `differences` gives.
        table: title and measures.
    """
    keys = (summary["variant"], summary["inference"], summary["D"], summary["ROW"], summary["method"])
    conditions = list(zip(*keys, strict=True))
    names = pd.DataFrame({m: [cell_name(*condition, m) for condition in conditions] for m in table.measures})
    means = Grid(table.title, readable(summary, table.measures), best(summary, table.measures), names)
    caption = f"{table.title}: differences between methods"
    return means, Grid(caption, readable_differences(paired, table.measures))


def note(measures: Sequence[str]) -> str:
    """How to read a table of these measures and its differences."""
    with_chance = not {"OAR", "WAR", "ACC"}.isdisjoint(measures)
    return " ".join([NOTE, *([CHANCE_NOTE] if with_chance else []), DIFFERENCE_NOTE])


def render(scores: pd.DataFrame, table: Table, folder: Path, name: str) -> None:
    """Write all files of a table: `catalogue.TABLE_ENDINGS` says how their names end.

    The CSV has one column a statistic, and `{measure}_best`; that of the differences one row a difference. The other
    forms hold what `grids` gives.

    Args:
        scores: all scores of the study.
        table: which of them, and the title.
        folder: where to write.
        name: how the files' names begin.
    """
    chosen = select(scores, table)
    summary, paired = summarise(chosen, table.measures), differences(chosen, table.measures)
    forms = text_forms(table.title, grids(summary, paired, table), note(table.measures))
    texts = {f".{form}": text for form, text in forms.items()}
    texts[".csv"] = _csv(summary.join(best(summary, table.measures).add_suffix("_best")))
    texts["_differences.csv"] = _csv(paired)
    for ending, text in texts.items():
        with replacing(folder / f"{name}{ending}") as (temporary,):
            temporary.write_text(text, encoding="utf-8")


def _csv(frame: pd.DataFrame) -> str:
    return frame.to_csv(index=False, lineterminator="\n", float_format="%.6f")
