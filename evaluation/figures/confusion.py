"""Confusion matrices of the description task, D × ROW, in the style of the paper's Figures 6 and 10."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evaluation.confusion import of_method
from evaluation.figures.drawing import PAGE_WIDTH, STYLE, page
from evaluation.figures.source import Source
from model import METHODS

PANEL_HEIGHT = 2.15
"""Inches. Four panels one below the other fill a page."""
SMALLEST_CELL = 11.0
"""Points. Counts in narrower cells could not be read."""


def confusion(source: Source) -> Figure:
    """The confusion matrices of one method."""
    counts = pd.concat([pd.read_csv(path) for path in source.files["counts"]], ignore_index=True)
    return confusion_figure(of_method(counts, source.names["method"]), source.settings["words"])


def confusion_figure(counts: pd.DataFrame, words: Mapping[str, Sequence[str]]) -> Figure:
    """Draw the confusion matrices of one method: a column of panels for each D, a row for each ROW.

    The shade is the share of the row, that is of how the true word was described; the numbers are the counts.
    Lines part the channels.

    Args:
        counts: What `evaluation.confusion.count_confusions` gives, of one condition but for D and ROW.
        words: The words by channel.
    """
    across, down = sorted(counts["D"].unique()), sorted(counts["ROW"].unique())
    panels = dict(list(counts.groupby(["D", "ROW"])))
    labels = list(dict.fromkeys(counts["true"]))
    edges = np.cumsum([len(own) for own in words.values()])
    heading = f"What the robot says of what the tutor called\n{_title(counts)}"
    with page(PANEL_HEIGHT * len(down) + 1.0, heading) as figure:
        grid: Any = figure.subplots(len(down), len(across), squeeze=False, sharex=True, sharey=True)
        image: Any = None
        for i, ROW in enumerate(down):
            for j, D in enumerate(across):
                if (D, ROW) not in panels:
                    grid[i, j].set_axis_off()
                    continue
                image = _panel(grid[i, j], _matrix(panels[D, ROW], labels), labels, edges, len(across))
                grid[i, j].set_title(f"D = {D}, ROW {ROW} %")
        figure.colorbar(image, ax=grid, label="share of the tutor's word", shrink=0.4, aspect=30, pad=0.01)
        figure.supxlabel("robot's word", fontsize=STYLE["font.size"])
        figure.supylabel("tutor's word", fontsize=STYLE["font.size"])
    return figure


def _title(counts: pd.DataFrame) -> str:
    shown = counts.iloc[0]
    method = METHODS[str(shown["method"])].label
    return f"{shown['experiment']}, {method}, sampler {shown['sampler']}, counts over all seeds"


def _matrix(panel: pd.DataFrame, labels: Sequence[str]) -> np.ndarray:
    wide = panel.pivot_table(index="true", columns="described", values="count", sort=False)
    return wide.reindex(index=list(labels), columns=list(labels), fill_value=0).to_numpy(dtype=np.int64)


def _panel(axes: Axes, counts: np.ndarray, labels: Sequence[str], edges: np.ndarray, across: int) -> Any:
    total = counts.sum(axis=1, keepdims=True)
    share = counts / np.maximum(total, 1)
    image = axes.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    places = range(len(labels))
    axes.set_xticks(places, labels, rotation=90)
    axes.set_yticks(places, labels)
    axes.tick_params(length=0, labelsize=7)
    axes.spines[:].set_visible(True)
    for edge in edges[edges < len(labels)]:
        axes.axhline(edge - 0.5, color="#555555", linewidth=0.8)
        axes.axvline(edge - 0.5, color="#555555", linewidth=0.8)
    if 72.0 * (PAGE_WIDTH - 1.3) / across / len(labels) >= SMALLEST_CELL:
        for row, column in np.argwhere(counts):
            dark = share[row, column] > 0.55
            axes.text(
                column, row, str(counts[row, column]), ha="center", va="center_baseline", fontsize=7,
                color="white" if dark else "black",
            )  # fmt: skip
    return image
