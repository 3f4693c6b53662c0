"""The figure of the features: what is drawn where."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle

from evaluation.figures.drawing import PAGE_WIDTH
from evaluation.figures.features import features_overview
from features.overview import Overview

CODEBOOK = np.array([[0, 0, 200], [200, 0, 0], [100, 0, 0]], dtype=np.uint8)


@pytest.fixture
def seen() -> Overview:
    """Three trials with four objects: two blue ones, a red and a dark red one."""
    words = ("blue", "blue", "red", "red")
    return Overview(
        trial=np.array([1, 2, 5]),
        boxes=(np.array([[2, 3, 12, 13]]), np.array([[5, 5, 9, 9], [20, 5, 30, 15]]), np.array([[1, 1, 4, 4]])),
        attended=np.array([0, 1, -1]),
        crops=np.arange(4, dtype=np.uint8)[:, None, None, None] * np.ones((1, 64, 64, 3), dtype=np.uint8),
        crop_group=np.array([0, 0, 0, 1]),
        codebook=CODEBOOK,
        histograms=np.array([[1.0, 0, 0], [1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]),
        histogram_words=words,
        actions=np.array([[0.0, 1.0], [0.5, 0.2], [0.1, 0.9]]),
        action_words=("reach", "touch", "touch"),
        action_names=("hand_x", "finger_rate"),
        projections={"object_feature": np.zeros((4, 2)), "color": np.ones((4, 2)), "action": np.zeros((3, 2))},
        projection_words={"object_feature": (None,) * 4, "color": words, "action": ("reach", "touch", "touch")},
    )


def test_what_is_drawn(seen: Overview) -> None:
    figure = features_overview(seen, [np.zeros((40, 60, 3), dtype=np.uint8)] * 3, "title")
    assert figure.get_size_inches()[0] == PAGE_WIDTH
    trials = [axes for axes in figure.axes if axes.get_title().startswith("trial")]
    assert [axes.get_title() for axes in trials] == ["trial 1", "trial 2", "trial 5"]
    edges = [[to_hex(box.get_edgecolor()) for box in axes.patches if isinstance(box, Rectangle)] for axes in trials]
    assert edges == [["#c1272d"], ["#1f5fa8", "#c1272d"], ["#1f5fa8"]], "the attended object is red"
    actions = next(axes for axes in figure.axes if axes.get_title().startswith("Action"))
    assert [label.get_text() for label in actions.get_xticklabels()] == ["hand_x", "finger_rate"]
    assert [label.get_text() for label in actions.get_yticklabels()] == ["reach", "touch"]
    crops = next(axes.images[0].get_array() for axes in figure.axes if len(axes.images) and len(axes.lines) == 1)
    assert crops is not None
    assert (crops[0, 0, 0], crops[0, 128, 0], crops[64, 0, 0]) == (0, 2, 3), "each group begins a new row"


def test_a_color_word_has_its_own_color(seen: Overview) -> None:
    """In any other color a legend that says red would mislead; of two reds it is the mean."""
    axes = next(axes for axes in features_overview(seen, [], "title").axes if axes.get_title() == "color")
    legend = axes.get_legend()
    assert legend is not None
    shades = [to_hex(patch.get_facecolor()) for patch in legend.get_patches()]
    assert dict(zip([text.get_text() for text in legend.get_texts()], shades, strict=True)) == {
        "blue": "#0000c8",
        "red": "#960000",
    }
    assert [to_hex(shade) for shade in axes.collections[0].get_facecolor()] == ["#0000c8"] * 2 + ["#960000"] * 2


def test_without_any_truth(seen: Overview) -> None:
    unknown = dict.fromkeys(seen.projection_words)
    blind = replace(seen, histogram_words=None, action_words=None, projection_words=unknown)
    titles = [axes.get_title() for axes in features_overview(blind, [], "title").axes]
    assert titles[-3:] == ["object feature", "color", "action"]
