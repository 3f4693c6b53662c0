"""The section of the report that tells what varies from data set to data set from what varies from seed to seed."""

from __future__ import annotations

import pandas as pd

from evaluation.measures import COMPARED
from evaluation.pages.page import Section
from evaluation.scores import varying
from evaluation.table_forms import Grid, by_measure, fragment, number
from evaluation.templates import render, wide
from evaluation.variance import pooled
from model import METHODS


def section(split: pd.DataFrame) -> Section:
    """The two parts of the variance of each measure, and the share of the data sets.

    Args:
        split: The rows of `variance.csv`, as `evaluation.variance.variance_split` gives them.
    """
    found = pooled(split)
    shown = wide(fragment(Grid("", _cells(found)), captioned=False)) if len(found) else ""
    alone = sorted(split.loc[split["datasets"] == 1, "experiment"].unique())
    return Section("variance", "Data sets and seeds", render("variance.html", table=shown, alone=alone), folded=True)


def _cells(found: pd.DataFrame) -> pd.DataFrame:
    """A row for each experiment, sampler and method, a column for each measure: `between | within (share)`."""
    keys = ["experiment", "sampler", "method"]
    numbers = zip(found["between"], found["within"], found["share_between"], strict=True)
    measures = [measure for measure in COMPARED if measure in set(found["measure"])]
    shown = by_measure(found, keys, [_cell(*values) for values in numbers], measures)
    shown["method"] = [METHODS[name].label for name in shown["method"]]
    return shown[[*varying(found, keys, "method"), *measures]]


def _cell(between: float, within: float, share: float) -> str:
    return f"{between:.3f} | {within:.3f} ({number(share, '.0%')})"
