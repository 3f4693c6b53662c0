"""What the robot sees, as one figure: detections, crops, colors, actions, and how far they tell the words apart."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.patches import Patch, Rectangle

from data_collection.image_files import mosaic
from data_collection.log.mcap_log import read_log
from data_collection.log.messages import Image
from data_collection.log.trial import observation
from evaluation.figures.drawing import page
from evaluation.figures.source import Source
from features.overview import Overview, overview
from features.percept_data import first, join, load_percepts
from features.table import read_table
from features.transforms import load_transforms

IMAGES = 8
CROPS_A_ROW = 20


def features(source: Source) -> Figure:
    """What the robot saw and felt in the training trials."""
    files, D = source.files, source.settings["D"]
    table = read_table(files["trials"][0], files["objects"][0], need_attention=True)
    percepts = first(join([load_percepts(path) for path in files["percepts"]]), D)
    seen = overview(percepts, load_transforms(files["transforms"][0]), table, source.settings["groups"])
    before = {one.trial: one.image_before for one in (observation(read_log(path)) for path in files["logs"])}
    # Where many trials were dropped, fewer than that are among the first logs.
    images = [before[trial] for trial in seen.trial[:IMAGES].tolist() if trial in before]
    return features_overview(seen, images, f"{source.names['experiment']}, D = {D}")


def features_overview(seen: Overview, images: Sequence[Image], title: str) -> Figure:
    """Draw an overview of the features of an experiment.

    Args:
        seen: The data, from `features.overview`.
        images: What the camera saw before the action, (H, W, 3) RGB, of the first trials of `seen`.
        title: Experiment and condition.
    """
    with page(11.0, f"What the robot sees and feels\n{title}") as figure:
        rows: Any = figure.subfigures(5, 1, height_ratios=(3.3, 2.1, 1.5, 3.2, 2.1))
        _detections(rows[0], seen, images)
        _crops(rows[1], seen)
        _colors(rows[2], seen)
        _actions(rows[3].subplots(), seen)
        _projections(rows[4], seen)
    return figure


def _detections(figure: SubFigure, seen: Overview, images: Sequence[Image]) -> None:
    figure.suptitle("Detections before the action (red: the attended object)")
    for d, axes in enumerate(figure.subplots(2, IMAGES // 2).flat):
        axes.set_axis_off()
        if d >= len(images):
            continue
        axes.imshow(images[d])
        axes.set_title(f"trial {seen.trial[d]}")
        for m, (left, top, right, bottom) in enumerate(seen.boxes[d]):
            edge = "#c1272d" if m == seen.attended[d] else "#1f5fa8"
            axes.add_patch(
                Rectangle(
                    (left - 0.5, top - 0.5), right - left, bottom - top, fill=False, edgecolor=edge, linewidth=1.5
                )
            )


def _crops(figure: SubFigure, seen: Overview) -> None:
    """Each group begins a new row; its crops come in the order of nearness to its centre."""
    figure.suptitle("Crops, by k-means of the object feature")
    axes = figure.subplots()
    axes.set_axis_off()
    size = seen.crops.shape[1]
    groups = [np.flatnonzero(seen.crop_group == group) for group in np.unique(seen.crop_group)]
    lines = [group[i : i + CROPS_A_ROW] for group in groups for i in range(0, len(group), CROPS_A_ROW)]
    axes.imshow(mosaic([seen.crops[line] for line in lines], CROPS_A_ROW, (size, size)))
    edges = np.cumsum([-(-len(group) // CROPS_A_ROW) for group in groups])[:-1]
    for edge in edges:
        axes.axhline(edge * size - 0.5, color="#555555", linewidth=1)


def _colors(figure: SubFigure, seen: Overview) -> None:
    figure.suptitle("Color histograms by true word; the bars are their codebook")
    axes = figure.subplots()
    left = np.zeros(len(seen.histograms))
    for shade, share in zip(seen.codebook / 255.0, seen.histograms.T, strict=True):
        axes.barh(np.arange(len(share)), share, left=left, color=shade, height=1.0)
        left += share
    axes.set_ylim(len(left) - 0.5, -0.5)
    axes.set_xlim(0, 1)
    axes.set_xlabel("share of the object's pixels")
    _label_groups(axes, seen.histogram_words)


def _actions(axes: Axes, seen: Overview) -> None:
    axes.set_title("Action features by true word, scaled to [0, 1]")
    image = axes.imshow(seen.actions, aspect="auto", cmap="viridis", vmin=0, vmax=1, interpolation="nearest")
    axes.set_xticks(range(len(seen.action_names)), seen.action_names, rotation=70, ha="right", rotation_mode="anchor")
    _label_groups(axes, seen.action_words)
    axes.figure.colorbar(image, ax=axes, shrink=0.7)


def _label_groups(axes: Axes, words: Sequence[str | None] | None) -> None:
    """Name each run of equal words on the vertical axis, and draw a line between runs."""
    if words is None:
        axes.set_yticks([])
        return
    starts = [i for i in range(len(words)) if i == 0 or words[i] != words[i - 1]]
    ends = [*starts[1:], len(words)]
    middles = [(start + end - 1) / 2 for start, end in zip(starts, ends, strict=True)]
    axes.set_yticks(middles, [words[start] or "unknown" for start in starts])
    for start in starts[1:]:
        axes.axhline(start - 0.5, color="white", linewidth=1.5)


def _projections(figure: SubFigure, seen: Overview) -> None:
    figure.suptitle("First two principal components, by true word")
    palette = mpl.colormaps["tab10"]
    for axes, (name, points) in zip(figure.subplots(1, len(seen.projections)), seen.projections.items(), strict=True):
        known = seen.projection_words[name] or (None,) * len(points)
        labels = sorted({word for word in known if word is not None})
        shades: dict[str | None, Any] = {word: palette(i % 10) for i, word in enumerate(labels)}
        if name == "color":
            shades |= _mean_colors(seen, labels)
        axes.scatter(points[:, 0], points[:, 1], c=[shades.get(word, "0.6") for word in known], s=10)
        marks = [Patch(color=shades[word], label=word) for word in labels]
        # Below the panel, where it hides no point.
        below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.12), "ncols": 2, "frameon": False}
        axes.legend(handles=marks, handlelength=1.0, **below)
        axes.set_title(name.replace("_", " "))


def _mean_colors(seen: Overview, words: Sequence[str]) -> dict[str | None, Any]:
    """The mean color of the objects that a color word is true of: red would be confusing in another one."""
    known = np.array(seen.histogram_words)
    return {word: seen.histograms[known == word].mean(axis=0) @ seen.codebook / 255.0 for word in words}
