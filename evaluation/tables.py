"""Tables of means and standard deviations over the seeds, in every form that people use."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from evaluation.catalogue import Table
from features.files import replacing
from model import METHODS

# What tells one row of a table from another, most general first; a key with one value is left out.
ROW_KEYS = ("variant", "inference", "averaged_draws", "chains", "D", "ROW", "method")


def select(scores: pd.DataFrame, table: Table) -> pd.DataFrame:
    """The scores that a table shows."""
    of_table = (scores.experiment == table.experiment) & (scores.task == table.task)
    return scores[of_table if table.D is None else of_table & (scores.D == table.D)]


def summarise(scores: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """Mean, standard deviation (n − 1) and number of seeds of each measure and condition.

    Args:
        scores: rows of `scores.csv` of one experiment and task.
        measures: which measures, in this order.

    Returns:
        One row a condition, in the order ROW, then method as in `METHODS`; columns `ROW_KEYS`, `seeds` (the
        number of seeds with a row), then `{measure}_mean`, `{measure}_sd`, `{measure}_n` (the number of
        seeds for which the measure is defined). Empty where no seed defines it.
    """
    keys = list(ROW_KEYS)
    grouped = scores[scores.measure.isin(measures)].groupby([*keys, "measure"], sort=False)["value"]
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
    order = {name: i for i, name in enumerate(METHODS)}
    result = result.reset_index()
    place = result["method"].map(order)
    return result.assign(place=place).sort_values([*keys[:-1], "place"]).drop(columns="place").reset_index(drop=True)


def readable(summary: pd.DataFrame, measures: Sequence[str]) -> pd.DataFrame:
    """The summary as people read it: `mean ± sd`, a dash where undefined, keys that never change left out."""
    shown = [key for key in ROW_KEYS if key in ("ROW", "method") or summary[key].nunique() > 1]
    result = summary[shown].copy()
    result["method"] = [METHODS[name].label for name in summary["method"]]
    for measure in measures:
        result[measure] = [
            _cell(*values) for values in zip(summary[f"{measure}_mean"], summary[f"{measure}_sd"], strict=True)
        ]
    result["seeds"] = summary["seeds"]
    return result.rename(columns={"ROW": "ROW (%)"})


def _cell(mean: float, sd: float) -> str:
    if np.isnan(mean):
        return "–"
    return f"{mean:.3f}" if np.isnan(sd) else f"{mean:.3f} ± {sd:.3f}"


def render(scores: pd.DataFrame, table: Table, paths: Mapping[str, Path]) -> None:
    """Write a table in several forms, each to its path.

    The CSV has one column a statistic; the others hold what `readable` gives.

    Args:
        scores: all scores of the study.
        table: which of them, and the title.
        paths: by form: csv, md, tex, html.
    """
    note = "Mean ± standard deviation (n − 1) over the seeds; the data are the same for all seeds."
    summary = summarise(select(scores, table), table.measures)
    shown, title = readable(summary, table.measures), table.title
    texts = {
        "csv": summary.to_csv(index=False, lineterminator="\n", float_format="%.6f"),
        "md": f"**{title}**\n\n{shown.to_markdown(index=False)}\n\n{note}\n",
        "tex": _latex(shown, title, note),
        "html": _HTML.format(title=title, table=shown.to_html(index=False, border=0), note=note),
    }
    for form, path in paths.items():
        with replacing(path) as (temporary,):
            temporary.write_text(texts[form], encoding="utf-8")


def _latex(shown: pd.DataFrame, title: str, note: str) -> str:
    cells = shown.astype(str).map(_escape)
    cells.columns = pd.Index([_escape(str(column)) for column in shown.columns])
    return str(
        cells.style.hide(axis="index").to_latex(
            caption=_escape(f"{title}. {note}"), hrules=True, column_format="l" * len(cells.columns)
        )
    )


def _escape(text: str) -> str:
    for symbol, replacement in (("_", r"\_"), ("%", r"\%"), ("±", r"$\pm$"), ("−", "$-$"), ("–", "--")):
        text = text.replace(symbol, replacement)
    return text


_HTML = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; margin: 2em; color: #222; }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums; }}
th, td {{ padding: .25em .9em; text-align: left; border-bottom: 1px solid #ddd; }}
thead th {{ border-top: 2px solid #222; border-bottom: 1px solid #222; }}
tbody tr:last-child td {{ border-bottom: 2px solid #222; }}
</style></head>
<body><h1>{title}</h1>
{table}
<p>{note}</p></body></html>
"""
