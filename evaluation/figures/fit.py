"""Figures of a fit, in the style of the paper's Figures 4 and 8."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle

from evaluation.figures.drawing import page
from evaluation.figures.source import Source
from evaluation.scores import LETTERS
from model import Fit


def words(source: Source) -> Figure:
    """The word distributions of the most probable fit."""
    _, fit, title = source.most_probable()
    return word_distributions(fit, source.settings["words"], title)


def positions(source: Source) -> Figure:
    """The position categories of the most probable fit."""
    _, fit, title = source.most_probable()
    return position_categories(fit, title)


def word_distributions(fit: Fit, words: Mapping[str, Sequence[str]], title: str) -> Figure:
    """θ as a heat map (Figure 4A): a row for each category in use, a column for each word of the vocabulary.

    A box surrounds each channel's own words; where words are learned well, the dark cells lie in the boxes.
    """
    known = [word for own in words.values() for word in own if word in fit.trials.vocabulary]
    columns = known + [word for word in fit.trials.vocabulary if word not in known]
    order = [fit.trials.vocabulary.index(word) for word in columns]
    rows: list[np.ndarray] = []
    labels: list[str] = []
    boxes: list[tuple[int, int, int, int]] = []
    for c, channel in enumerate(fit.trials.channels):
        used = np.unique(fit.state.z[c])
        own = [columns.index(word) for word in words.get(channel.name, ()) if word in columns]
        if own:
            boxes.append((min(own), len(labels), len(own), len(used)))
        rows.append(np.exp(fit.state.log_words[c][used])[:, order])
        labels += [f"{LETTERS.get(channel.name, channel.name)}{k + 1}" for k in range(len(used))]
    with page(1.3 + 0.17 * len(labels)) as figure:
        axes = figure.subplots()
        image = axes.imshow(np.concatenate(rows), cmap="Greys", vmin=0.0, vmax=1.0, aspect="auto")
        for left, top, width, height in boxes:
            frame = Rectangle((left - 0.5, top - 0.5), width, height, fill=False, edgecolor="#c1272d", linewidth=2)
            frame.set_clip_on(False)
            axes.add_patch(frame)
        axes.set_xticks(range(len(columns)), columns, rotation=60, ha="right", rotation_mode="anchor")
        axes.set_yticks(range(len(labels)), labels)
        axes.set_ylabel("category in use")
        axes.set_title(f"Word distributions θ\n{title}")
        figure.colorbar(image, ax=axes, label="probability of the word", shrink=0.6)
    return figure


def position_categories(fit: Fit, title: str) -> Figure:
    """Gaussians of the position categories over the table, with the data (Figure 4B).

    Ellipses are at two standard deviations; a category is named by the word that it most probably utters.
    """
    c = fit.trials.index_of("position")
    z, points = fit.state.z[c], fit.trials.channels[c].features
    palette = mpl.colormaps["tab10"]
    behind = {"facecolor": "white", "alpha": 0.7, "edgecolor": "none", "pad": 1.0}
    with page(4.6) as figure:
        axes = figure.subplots()
        for i, k in enumerate(np.unique(z)):
            own, shade = points[z == k], palette(i % 10)
            axes.plot(own[:, 1], own[:, 0], "x", color=shade, markersize=6)
            _ellipse(axes, fit.state.mean[c][k], fit.state.factor[c][k], shade)
            above = (own[:, 1].mean(), own[:, 0].max())  # the crosses stay in sight
            place: dict[str, Any] = {"xytext": (0, 6), "textcoords": "offset points", "ha": "center", "va": "bottom"}
            axes.annotate(category_label(fit, c, i, int(k)), above, color=shade, weight="bold", bbox=behind, **place)
        axes.set_aspect("equal", adjustable="datalim")
        axes.autoscale_view()
        axes.invert_xaxis()
        axes.set_xlabel("y: to the robot's left (m)")
        axes.set_ylabel("x: ahead of the robot (m)")
        axes.set_title(f"Position categories\n{title}")
    return figure


def category_label(fit: Fit, c: int, i: int, k: int) -> str:
    """Name the i-th category in use, k, of channel c by its letter, number from 1 and most probable word."""
    letter = LETTERS.get(fit.trials.channels[c].name, fit.trials.channels[c].name)
    if not fit.trials.vocabulary:
        return f"{letter}{i + 1}"
    return f"{letter}{i + 1} “{fit.trials.vocabulary[int(np.argmax(fit.state.log_words[c][k]))]}”"


def _ellipse(axes: Axes, mean: np.ndarray, factor: np.ndarray, shade: Any) -> None:
    variances, directions = np.linalg.eigh(factor @ factor.T)
    # Drawn with y along the horizontal axis, so that the components change places.
    angle = np.degrees(np.arctan2(directions[0, 1], directions[1, 1]))
    height, width = 4.0 * np.sqrt(variances)
    for fill, opacity in ((True, 0.12), (False, 1.0)):
        axes.add_patch(
            Ellipse(
                (mean[1], mean[0]), width, height, angle=angle, color=shade, fill=fill, alpha=opacity, linewidth=1.5
            )
        )
