"""How a fit understands instructions: the probability of every object and action category."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from evaluation.figures.drawing import page
from evaluation.figures.source import Source
from evaluation.generation import answers
from evaluation.uncertain.scenes import scene_of
from features.table import FeatureTable, read_table
from model import Fit

SHOWN = 12
"""Sentences that the figure of the answers shows; a test set of one's own may hold many more."""
COLUMNS = 2


def instructions(source: Source) -> Figure:
    """How the most probable fit understands the instructions of the test set."""
    _, fit, title = source.most_probable()
    table = read_table(source.files["trials"][0], source.files["objects"][0], need_attention=False)
    return answers_figure(fit, table, title)


def answers_figure(fit: Fit, table: FeatureTable, title: str) -> Figure:
    """p(object, action category | sentence) of a table's first instructions, a heat map each.

    A row is an object, named by its true words where they are known, and boxed if it is the instructed one. A column
    is an action category, first those in use with the word that each most probably utters, then the others; the
    lowest map of each column names them.
    """
    shown = answers(fit, table)[:SHOWN]
    categories = fit.knowledge.categories
    used = np.unique(categories.z[0])
    order = [*used, *np.setdiff1d(np.arange(len(categories.mean[0])), used)]
    most = max(len(answer.log_scores) for answer in shown)
    columns = min(COLUMNS, len(shown))
    rows = -(-len(shown) // columns)
    with page(1.9 + rows * (0.3 + 0.17 * most)) as figure:
        panels: Any = figure.subplots(rows, columns, squeeze=False).ravel()
        for spare in panels[len(shown) :]:
            spare.set_axis_off()
        shades = mpl.cm.ScalarMappable(mpl.colors.Normalize(0.0, 1.0), "Greys")
        for d, (axes, answer) in enumerate(zip(panels, shown, strict=False)):
            axes.imshow(answer.probabilities[:, order], norm=shades.norm, cmap=shades.cmap, aspect="auto")
            _numbers(axes, answer.probabilities[:, order])
            instructed = int(table.attended_object[d])
            if instructed >= 0:
                frame = Rectangle(
                    (-0.5, instructed - 0.5), len(order), 1, fill=False, edgecolor="#c1272d", linewidth=2
                )
                frame.set_clip_on(False)
                axes.add_patch(frame)
            lowest = d + columns >= len(shown)
            names = _category_names(fit, used, len(order)) if lowest else []
            axes.set_xticks(range(len(names)), names, rotation=60, ha="right", rotation_mode="anchor")
            axes.set_yticks(range(len(answer.log_scores)), _object_names(table, d))
            left_out = f" (not known: {', '.join(answer.ignored)})" if answer.ignored else ""
            axes.set_title(f"“{' '.join(table.words[d])}”{left_out}", fontsize=8)
        figure.suptitle(f"p(object, action category | sentence)\n{title}")
        figure.colorbar(shades, ax=list(panels), label="probability", location="bottom", shrink=0.4, aspect=30)
    return figure


def _numbers(axes: Axes, probabilities: np.ndarray) -> None:
    """Write the probabilities that are not small into their cells."""
    for m, k in np.argwhere(probabilities >= 0.05):
        shade = "white" if probabilities[m, k] > 0.5 else "black"
        number = f"{probabilities[m, k]:.2f}".removeprefix("0")
        axes.text(k, m, number, ha="center", va="center", fontsize=7, color=shade)


def _category_names(fit: Fit, used: np.ndarray, count: int) -> list[str]:
    """Names as in the figure of word distributions, with each category's most probable word."""
    words = fit.trials.vocabulary
    names = [
        f"a{i + 1} {words[int(np.argmax(fit.knowledge.categories.log_words[0][k]))]}" if words else f"a{i + 1}"
        for i, k in enumerate(used)
    ]
    return names + ["unused"] * (count - len(used))


def _object_names(table: FeatureTable, row: int) -> list[str]:
    """The true words of a trial's objects, or their numbers where not a word is known."""
    words = zip(*scene_of(table, row).truth.values(), strict=True)
    return [" ".join(filter(None, own)) or f"object {m}" for m, own in enumerate(words)]
