"""How fits answer uncertain instructions, by the number of objects that fit and by kind of sentence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evaluation.figures.drawing import page
from evaluation.figures.source import Source
from evaluation.uncertain.answers import by_seed, of_condition, read_uncertain
from evaluation.uncertain.instructions import KINDS
from model import METHODS


def uncertain(source: Source) -> Figure:
    """The answers of all methods and seeds under one condition."""
    shown = source.settings["condition"]
    answered = of_condition(read_uncertain(source.files["answers"]), shown)
    return uncertain_figure(answered, f"{shown['experiment']}, D = {shown['D']}, ROW {shown['ROW']} %")


def uncertain_figure(answered: pd.DataFrame, title: str) -> Figure:
    """Entropy against the number of fitting objects, and by kind how often a fitting object is chosen.

    Args:
        answered: The rows of the fits of one condition, all methods and seeds.
        title: The condition.
    """
    methods = [method for method in METHODS if method in set(answered["method"])]
    with page(6.6) as figure:
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
            list(legend.values()), list(legend), loc="outside lower center", ncols=min(4, len(legend)), frameon=False
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
