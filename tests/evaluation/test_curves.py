"""Learning curves show the means of the scores, with intervals that come from their spread."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

from evaluation.figures.curves import curves_figure, interval, interval_note, over_omission
from evaluation.figures.source import Source
from evaluation.scores import UNITS
from tests.evaluation.hand_made import scores_of

# EAR of A and B at two D and three ROW, and of ALL, which hears nothing.
EAR = {
    ("csl", "proposed", 20, 0, "EAR"): [0.9, 0.8],
    ("csl", "proposed", 20, 40, "EAR"): [0.6, 0.8],
    ("csl", "proposed", 20, 60, "EAR"): [0.5, 0.5],
    ("csl", "proposed", 40, 0, "EAR"): [1.0, 1.0],
    ("csl", "proposed", 40, 40, "EAR"): [0.8, 0.8],
    ("csl", "proposed", 40, 60, "EAR"): [0.7, 0.9],
    ("csl", "no_mec2", 20, 0, "EAR"): [0.4, 0.6],
    ("csl", "no_mec2", 20, 40, "EAR"): [0.2, 0.2],
    ("csl", "gmm", 20, 100, "ARI_p"): [0.3, 0.5],
    ("csl", "proposed", 20, 0, "ARI_p"): [0.7, 0.9],
    ("csl", "proposed", 20, 40, "ARI_p"): [0.6, 0.6],
}


def curves(figure: Figure, row: int = 0) -> list[tuple[list[float], list[float]]]:
    """Places and heights of the error bars of a panel."""
    axes: Any = figure.axes[row]
    return [(list(bar[0].get_xdata()), [round(y, 6) for y in bar[0].get_ydata()]) for bar in axes.containers]


def test_curves_are_the_means_at_the_extremes() -> None:
    figure = curves_figure(scores_of(EAR), "ROW")
    assert [axes.get_ylabel() for axes in figure.axes] == ["ARI p", "EAR"]
    assert curves(figure, 1) == [
        ([0, 40, 60], [1.0, 0.8, 0.8]),  # D = 40 before D = 20
        ([0, 40, 60], [0.85, 0.7, 0.5]),
        ([0, 40], [0.5, 0.2]),
    ]
    # ALL has no ROW: a line across.
    (line,) = [line for line in figure.axes[0].lines if list(line.get_xdata()) == [0, 1]]
    assert list(line.get_ydata()) == pytest.approx([0.4, 0.4])
    over_D = curves(curves_figure(scores_of(EAR), "D"))
    assert over_D == [([20, 40], [0.85, 1.0]), ([20, 40], [0.5, 0.8]), ([20], [0.5])]


def test_samplers_stand_side_by_side() -> None:
    scores = scores_of(EAR)
    figure = curves_figure(pd.concat([scores, scores.assign(sampler="mixing", value=0.5)]), "ROW")
    assert [axes.get_title() for axes in figure.axes][:2] == ["sampler published", "sampler mixing"]
    assert {y for _, ys in curves(figure, 1) for y in ys} == {0.5}


@pytest.mark.parametrize("spread", [0.0, 0.1])
def test_intervals_are_as_wide_as_the_spread_makes_them(spread: float) -> None:
    """Of ten seeds: 2 · 1.96 · sd / √10."""
    values = pd.Series(np.linspace(0.5 - spread * 1.5, 0.5 + spread * 1.5, 10), name="value")
    index = pd.MultiIndex.from_product([[1], range(10)], names=UNITS)
    mean, low, high = interval(values.set_axis(index))
    assert mean == pytest.approx(0.5)
    assert high - low == pytest.approx(2 * 1.96 * float(values.std(ddof=0)) / np.sqrt(10), rel=0.05)


@pytest.mark.parametrize(
    ("sets", "says"), [([1], "2 seeds of one data set"), ([1, 2], "over 2 data sets and 2 seeds")]
)
def test_it_says_what_intervals_are_over(sets: Sequence[int], says: str) -> None:
    scores = pd.concat([scores_of(EAR, dataset=one) for one in sets])
    assert says in interval_note(scores)
    assert says in str(curves_figure(scores, "ROW").get_suptitle())


def test_nothing_defined_is_said() -> None:
    figure = curves_figure(scores_of(EAR).assign(value=np.nan), "ROW")
    assert not figure.axes
    assert "no measure is defined at two values of ROW" in str(figure.get_suptitle())


def test_other_experiments_and_variants_are_left_out(tmp_path: Path) -> None:
    scores = scores_of(EAR)
    others = [scores.assign(experiment="real", value=0.1), scores.assign(variant="few", value=0.1)]
    pd.concat([*others, scores]).to_csv(tmp_path / "scores.csv", index=False)
    source = Source({"experiment": "simulator"}, {"scores": [tmp_path / "scores.csv"]}, {"variant": "default"})
    assert curves(over_omission(source), 1) == curves(curves_figure(scores, "ROW"), 1)
