"""Figures of action generation: what is drawn."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.container import ErrorbarContainer
from matplotlib.patches import Rectangle

from evaluation.figures.drawing import save_figure
from evaluation.figures.instructions import answers_figure
from evaluation.figures.uncertain import uncertain_figure
from evaluation.generation import answers, write_distributions
from evaluation.uncertain.answers import answer_uncertain
from evaluation.uncertain.instructions import KINDS, instructions
from features.table import FeatureTable, head
from model import Fit
from tests.evaluation.conftest import fit_of
from tests.evaluation.test_uncertain import CONDITION
from tests.synthetic import WORDS


@pytest.fixture(scope="module")
def answered(table: FeatureTable) -> pd.DataFrame:
    """Two seeds of two methods."""
    asked = instructions(head(table, 4), WORDS)
    rows = [
        row
        for method in ("proposed", "mmlda")
        for seed in (1, 2)
        for row in answer_uncertain(CONDITION | {"method": method, "seed": seed}, fit_of(table, method), asked)
    ]
    return pd.DataFrame(rows)


def test_a_heat_map_for_each_sentence(proposed: Fit, table: FeatureTable) -> None:
    figure = answers_figure(proposed, table, "title")
    expected = answers(proposed, table)
    assert len(expected) == 12
    used = np.unique(proposed.state.z[0])
    for d, (axes, answer) in enumerate(zip(figure.axes, expected, strict=False)):
        shown = np.asarray(axes.images[0].get_array())
        assert shown.sum() == pytest.approx(1.0)
        assert np.array_equal(shown[:, : len(used)], answer.probabilities[:, used])
        boxes = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
        assert [box.get_y() + 0.5 for box in boxes] == [table.attended_object[d]]
        assert axes.get_title() == f"“{' '.join(table.words[d])}”"
        names = [label.get_text().split() for label in axes.get_yticklabels()]
        assert set(names[table.attended_object[d]]) < set(table.words[d])


def test_an_object_without_truth_has_a_number_and_no_box(proposed: Fit, table: FeatureTable) -> None:
    first = head(table, 1)
    blind = replace(
        first, attended_object=np.array([-1]), truth_position=None, truth_object=None, truth_color=None,
        words=(("cup", "blorp"),),
    )  # fmt: skip
    axes = answers_figure(proposed, blind, "title").axes[0]
    assert not axes.patches
    assert axes.get_yticklabels()[0].get_text() == "object 0"
    assert axes.get_title() == "“cup blorp” (not known: blorp)"


def test_entropies_stand_against_the_number_that_fit(answered: pd.DataFrame) -> None:
    axes = uncertain_figure(answered, "title").axes[0]
    line = next(line for line in axes.lines if line.get_label() == "ln of the number")
    x, y = np.asarray(line.get_xdata(), dtype=float), np.asarray(line.get_ydata(), dtype=float)
    assert np.allclose(np.exp(y), x)
    right = answered[
        (answered.method == "proposed") & ~answered.kind.isin(["five_words", "repeated_channel", "no_fit"])
    ]
    expected = right[right.fitting > 0].groupby("fitting")["entropy"].mean()
    points = next(part for part in axes.containers if isinstance(part, ErrorbarContainer)).lines[0]
    assert points is not None
    assert np.allclose(np.asarray(points.get_ydata(), dtype=float), expected)


def test_rates_by_kind(answered: pd.DataFrame) -> None:
    _, outvoted, rates = uncertain_figure(answered, "title").axes[:3]
    shown = [label.get_text() for label in outvoted.get_yticklabels()]
    assert shown == [kind.label for kind in KINDS.values() if kind.wrong]
    assert [label.get_text() for label in rates.get_yticklabels()][:5] == [
        KINDS[f"words_{n}"].label for n in range(5)
    ]


def test_figures_without_any_truth(proposed: Fit, table: FeatureTable, out: Path) -> None:
    blind = replace(head(table, 2), truth_position=None, truth_object=None, truth_color=None)
    rows = answer_uncertain(CONDITION, proposed, instructions(blind, WORDS))
    for name in ("a.png", "a.pdf", "b.pdf"):
        save_figure(uncertain_figure(pd.DataFrame(rows), "title"), out / name)
    assert (out / "a.pdf").read_bytes() == (out / "b.pdf").read_bytes()


def test_the_whole_distribution_is_written(proposed: Fit, table: FeatureTable, out: Path) -> None:
    answered = answers(proposed, table)
    write_distributions(table, answered, out / "scores.csv")
    kept = pd.read_csv(out / "scores.csv")
    assert len(kept) == sum(answer.log_scores.size for answer in answered)
    assert np.allclose(kept.groupby("trial")["probability"].sum(), 1.0)
    third = kept[kept.trial == table.trial[2]].pivot_table(index="object", columns="category", values="log_score")
    assert np.allclose(third.to_numpy(), answered[2].log_scores)
