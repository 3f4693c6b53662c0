"""Learning curves: every measure over the number of trials and over the omitted words, by method and sampler."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from data_collection.seeding import generator
from evaluation.figures.drawing import page
from evaluation.figures.source import Source
from evaluation.measures import shown
from evaluation.replicates import bootstrap, several
from evaluation.scores import UNITS, read_scores
from model import METHODS

TASKS = ("csl", "description", "generation")
AXIS = {"ROW": "words omitted (%)", "D": "trials learned from (D)"}
PANEL_HEIGHT = 1.05
"""Inches; seven measures fill a page."""
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000", "#56b4e9", "#e69f00")
_LINES: tuple[Literal["-"], Literal[":"]] = ("-", ":")


def _over(along: str, source: Source) -> Figure:
    """Each measure over ROW, or D, at the extremes of the other."""
    scores = read_scores(source.files["scores"])
    own = (scores["experiment"] == source.names["experiment"]) & (scores["variant"] == source.settings["variant"])
    return curves_figure(pd.DataFrame(scores[own]), along)


over_omission = partial(_over, "ROW")
over_trials = partial(_over, "D")


def curves_figure(scores: pd.DataFrame, along: str) -> Figure:
    """Draw a row of panels per measure, a column per sampler; means with 95 % intervals.

    Intervals are those of the hierarchical bootstrap: over the data sets, and over the seeds within them. Where no
    measure is defined at two places of the axis, the figure says so.

    Args:
        scores: Rows of `scores.csv` of one experiment and variant.
        along: What the horizontal axis is, `ROW` or `D`; of the other the extremes are drawn, as two kinds of lines.
    """
    heard = scores[[METHODS[method].hears_words for method in scores["method"]]].dropna(subset=["value"])
    other = "D" if along == "ROW" else "ROW"
    extremes = sorted({heard[other].min(), heard[other].max()}, reverse=other == "D")
    places = heard[heard[other].isin(extremes)].groupby("measure")[along].nunique()
    measures = [name for name in shown(TASKS) if places.get(name, 0) > 1]
    samplers = list(scores["sampler"].unique())
    methods = [name for name in METHODS if name in set(scores["method"])]
    experiment, variant = scores[["experiment", "variant"]].iloc[0]
    heading = f"{experiment}, variant {variant}: measures over {AXIS[along]}\n{interval_note(scores)}"
    if not measures:
        with page(1.0, f"{heading}\nno measure is defined at two values of {along}") as figure:
            return figure
    with page(PANEL_HEIGHT * len(measures) + 1.3, heading) as figure:
        grid: Any = figure.subplots(len(measures), len(samplers), squeeze=False, sharex=True, sharey="row")
        for column, sampler in enumerate(samplers):
            grid[0, column].set_title(f"sampler {sampler}")
            grid[-1, column].set_xlabel(AXIS[along])
            grid[-1, column].set_xticks(sorted(heard[along].unique()))
            for row, measure in enumerate(measures):
                own = scores[(scores["sampler"] == sampler) & (scores["measure"] == measure)]
                _panel(grid[row, column], own.dropna(subset=["value"]), methods, (along, other), extremes)
        for row, measure in enumerate(measures):
            grid[row, 0].set_ylabel(measure.replace("_", " "))
        legend = _legend(methods, other, extremes)
        figure.legend(handles=legend, loc="outside lower center", ncols=3, frameon=False)
    return figure


def interval_note(scores: pd.DataFrame) -> str:
    """What stands behind the bars, as the heading says it."""
    seeds = f"{scores['seed'].nunique()} seeds"
    if several(scores):
        return f"means and 95 % bootstrap intervals over {scores['dataset'].nunique()} data sets and {seeds} of each"
    return f"means and 95 % bootstrap intervals over {seeds} of one data set"


def interval(values: pd.Series[float]) -> tuple[float, float, float]:
    """Mean, and the bounds of its 95 % interval, of values indexed by `UNITS`."""
    draws = bootstrap([values], generator(0, "curves"))
    low, high = np.quantile(draws, (0.025, 0.975))
    return float(values.groupby(level=UNITS[0]).mean().mean()), float(low), float(high)


def _panel(
    axes: Axes, own: pd.DataFrame, methods: Sequence[str], axis: tuple[str, str], extremes: Sequence[Any]
) -> None:
    """The curves of one measure and sampler."""
    along, other = axis
    for i, method in enumerate(methods):
        mine = own[own["method"] == method]
        if not METHODS[method].hears_words and other == "ROW":
            mine = mine.assign(ROW=extremes[0])  # hears nothing, whatever is omitted
        for extreme, line in zip(extremes, _LINES, strict=False):
            groups = mine[mine[other] == extreme].groupby(along)
            points = {at: interval(rows.set_index(UNITS)["value"]) for at, rows in groups}
            if not METHODS[method].hears_words and along == "ROW":
                for mean, _, _ in points.values():
                    axes.axhline(mean, color=_color(i), linestyle=line, linewidth=0.8)
                continue
            if points:
                mean, low, high = np.array(list(points.values())).T
                style: Any = {"color": _color(i), "linestyle": line, "linewidth": 1, "marker": "o", "markersize": 2.5}
                # The mean lies in the interval but for rounding.
                spread = np.maximum([mean - low, high - mean], 0.0)
                axes.errorbar(list(points), mean, spread, elinewidth=0.8, **style)


def _color(i: int) -> str:
    return _COLORS[i % len(_COLORS)]


def _legend(methods: Sequence[str], other: str, extremes: Sequence[Any]) -> list[Line2D]:
    named = [Line2D([], [], color=_color(i), label=METHODS[method].label) for i, method in enumerate(methods)]
    unit = " %" if other == "ROW" else ""
    kinds = [
        Line2D([], [], color="0.4", linestyle=_LINES[i], label=f"{other} {extreme}{unit}")
        for i, extreme in enumerate(extremes)
    ]
    return named + kinds
