"""Figures of action generation: how each sentence is understood, and how uncertain ones are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from evaluation.figures.drawing import PAGE_WIDTH, STYLE
from evaluation.generation import answers
from evaluation.uncertain.answers import by_seed
from evaluation.uncertain.instructions import KINDS
from evaluation.uncertain.scenes import OBJECT_CHANNELS
from features.table import FeatureTable
from model import METHODS, Fit

SHOWN = 12
"""Sentences that the figure of the answers shows; a test set of one's own may hold many more."""
COLUMNS = 2


def answers_figure(fit: Fit, table: FeatureTable, title: str) -> Figure:
    """p(object, action category | sentence) of a table's first instructions, a heat map each.

    A row is an object, named by its true words where they are known, and boxed if it is the instructed one. A column
    is an action category, first those in use with the word that each most probably utters, then the others; the
    lowest map of each column names them.
    """
    shown = answers(fit, table)[:SHOWN]
    used = np.unique(fit.state.z[0])
    order = [*used, *np.setdiff1d(np.arange(len(fit.state.mean[0])), used)]
    most = max(len(answer.log_scores) for answer in shown)
    columns = min(COLUMNS, len(shown))
    rows = -(-len(shown) // columns)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(PAGE_WIDTH, 1.9 + rows * (0.3 + 0.17 * most)), layout="constrained")
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


def uncertain_figure(answered: pd.DataFrame, title: str) -> Figure:
    """Entropy against the number of fitting objects, and by kind how often a fitting object is chosen.

    Args:
        answered: the rows of the fits of one condition, all methods and seeds.
        title: the condition.
    """
    methods = [method for method in METHODS if method in set(answered["method"])]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(PAGE_WIDTH, 6.6), layout="constrained")
        parts: Any = figure.subfigures(2, 1, height_ratios=(1.0, 1.4))
        entropy, outvoted = parts[0].subplots(1, 2)
        rates = parts[1].subplots()
        _entropy(entropy, answered, methods)
        _rates(rates, answered, methods, "OAR_fit", "chance_fit")
        rates.set_xlabel("OAR among the objects that fit")
        _rates(outvoted, answered, methods, "outvoted", "chance_outvoted")
        outvoted.set_xlabel("wrong word outvoted:\nthe instructed object is chosen")
        marks = [axes.get_legend_handles_labels() for axes in (entropy, rates)]
        legend = {label: handle for handles, labels in marks for handle, label in zip(handles, labels, strict=True)}
        parts[1].legend(
            list(legend.values()), list(legend), loc="outside lower center", ncols=len(legend), frameon=False
        )
        figure.suptitle(f"Uncertain instructions\n{title}")
    return figure


def _entropy(axes: Axes, answered: pd.DataFrame, methods: Sequence[str]) -> None:
    """Mean entropy by the number of fitting objects, where no word is wrong; deviations are over the seeds."""
    right = answered[~answered["kind"].map({name: kind.wrong for name, kind in KINDS.items()})]
    known = right[right["fitting"] > 0]
    counts = sorted(int(count) for count in known["fitting"].unique())
    means = by_seed(known, "fitting", ["entropy"])
    for i, method in enumerate(methods):
        own = means[means["method"] == method].groupby("fitting")["entropy"].agg(["mean", "std"])
        axes.errorbar(
            own.index.to_numpy() + _aside(i, len(methods), 0.1), own["mean"], own["std"].fillna(0.0), **_marks(method)
        )
    line = np.linspace(1.0, max(counts, default=2), 100)
    axes.plot(line, np.log(line), color="black", linewidth=1, label="ln of the number", zorder=1)
    axes.set_xticks(counts)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("objects that fit the sentence")
    axes.set_ylabel("entropy of p(object | sentence) (nats)")


def _rates(axes: Axes, answered: pd.DataFrame, methods: Sequence[str], measure: str, chance: str) -> None:
    """A measure by kind (from above) and method; a gray line marks the chance level."""
    known = answered.dropna(subset=[measure])
    present = [kind for kind in KINDS if kind in set(known["kind"])]
    place = {kind: float(i) for i, kind in enumerate(present)}
    means = by_seed(known, "kind", [measure])
    levels = known.drop_duplicates(["trial", "kind", "instruction"]).groupby("kind")[chance].mean()
    axes.vlines(
        [levels[kind] for kind in present],
        [place[kind] - 0.4 for kind in present],
        [place[kind] + 0.4 for kind in present],
        color="0.6",
        linewidth=3,
        label="chance",
    )
    for i, method in enumerate(methods):
        own = means[means["method"] == method].groupby("kind")[measure].agg(["mean", "std"]).reindex(present)
        heights = [place[kind] + _aside(i, len(methods), 0.22) for kind in present]
        spread = own["std"].fillna(0.0)
        within = np.minimum([spread, spread], [own["mean"], 1.0 - own["mean"]])  # a share is at most 1
        axes.errorbar(own["mean"], heights, xerr=within, **_marks(method))
    axes.set_yticks(list(place.values()), [KINDS[kind].label for kind in present])
    axes.set_ylim(max(len(present), 1) - 0.5, -0.5)
    axes.set_xlim(0.0, 1.03)


def _aside(i: int, count: int, step: float) -> float:
    return (i - (count - 1) / 2) * step


_SHAPES = "os^Dv<>"
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")


def _marks(method: str) -> dict[str, Any]:
    """How a method is drawn, told apart by color and by shape."""
    i = list(METHODS).index(method)
    return {
        "fmt": _SHAPES[i % len(_SHAPES)],
        "color": _COLORS[i % len(_COLORS)],
        "markersize": 5,
        "capsize": 2,
        "linewidth": 1,
        "label": METHODS[method].label,
    }


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
        f"a{i + 1} {words[int(np.argmax(fit.state.log_words[0][k]))]}" if words else f"a{i + 1}"
        for i, k in enumerate(used)
    ]
    return names + ["unused"] * (count - len(used))


def _object_names(table: FeatureTable, row: int) -> list[str]:
    """The true words of a trial's objects, or their numbers where not a word is known."""
    own = np.flatnonzero(table.trial_index == row)
    truths = [getattr(table, f"truth_{channel}") for channel in OBJECT_CHANNELS]
    names = [[truth[i] for truth in truths if truth is not None and truth[i] is not None] for i in own]
    return [" ".join(name) or f"object {m}" for m, name in enumerate(names)]
