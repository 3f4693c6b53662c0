"""Figures: what is drawn, and that it is drawn the same again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.patches import Ellipse, Rectangle

from evaluation.figures import position_categories, save_figure, word_distributions
from model import Fit
from tests.synthetic import WORDS


def test_the_heat_map_holds_theta_of_the_categories_in_use(proposed: Fit) -> None:
    axes = word_distributions(proposed, WORDS, "title").axes[0]
    shown = np.asarray(axes.images[0].get_array())
    used = sum(len(np.unique(z)) for z in proposed.state.z)
    assert shown.shape == (used, len(proposed.trials.vocabulary))
    assert np.allclose(shown.sum(axis=1), 1.0)
    words = [label.get_text() for label in axes.get_xticklabels()]
    assert words == [word for own in WORDS.values() for word in own if word in proposed.trials.vocabulary]
    first_color = [label.get_text() for label in axes.get_yticklabels()].index("c1")
    k, w = np.unique(proposed.state.z[3])[0], proposed.trials.vocabulary.index("red")
    assert shown[first_color, words.index("red")] == np.exp(proposed.state.log_words[3][k, w])


def test_a_box_surrounds_each_channels_own_words(proposed: Fit) -> None:
    figure = word_distributions(proposed, WORDS, "title")
    boxes = [patch for patch in figure.axes[0].patches if isinstance(patch, Rectangle)]
    assert len(boxes) == 4
    heights = [box.get_height() for box in boxes]
    assert heights == [len(np.unique(z)) for z in proposed.state.z]


def test_ellipses_are_the_gaussians(proposed: Fit) -> None:
    """A point on the ellipse is at two standard deviations (Mahalanobis distance 2)."""
    figure = position_categories(proposed, "title")
    ellipses = [patch for patch in figure.axes[0].patches if isinstance(patch, Ellipse) and patch.get_fill()]
    used = np.unique(proposed.state.z[1])
    assert len(ellipses) == len(used)
    for ellipse, k in zip(ellipses, used, strict=True):
        outline = ellipse.get_patch_transform().transform(np.array([[1.0, 0.0], [0.0, 1.0], [0.6, 0.8]]))
        white = np.linalg.solve(proposed.state.factor[1][k], (outline[:, ::-1] - proposed.state.mean[1][k]).T)
        assert np.allclose(np.linalg.norm(white, axis=0), 2.0)


def test_left_is_left(proposed: Fit) -> None:
    axes = position_categories(proposed, "title").axes[0]
    left, right = axes.get_xlim()
    assert left > right


def test_the_same_figure_gives_the_same_bytes(proposed: Fit, out: Path) -> None:
    for name in ("a.png", "b.png", "a.pdf", "b.pdf"):
        save_figure(word_distributions(proposed, WORDS, "title"), out / name)
    assert (out / "a.png").read_bytes() == (out / "b.png").read_bytes()
    assert (out / "a.pdf").read_bytes() == (out / "b.pdf").read_bytes()
