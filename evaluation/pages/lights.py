"""The lights of a study as people see them: a color and a word for each condition, and the rules behind."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

import numpy as np
import pandas as pd

from data_collection.files import write_text
from evaluation.convergence import AMBER, BY_CHANCE, ENOUGH, GOAL, GREEN, LIGHTS, RED, TOLERATED, UNCHECKED, counted
from evaluation.data_sets import data_set_name
from evaluation.pages.page import Part, Section, page, table
from evaluation.scores import ROW_KEYS, varying
from evaluation.templates import render
from model import METHODS
from model.diagnostics import FRAME, MEAN_PRECISION, WORD

MARKS = {GREEN: "mark yes", AMBER: "mark some", RED: "mark no", UNCHECKED: "mark"}
LIMITS = {"GOAL": GOAL, "ENOUGH": ENOUGH, "TOLERATED": TOLERATED, "BY_CHANCE": BY_CHANCE}


def mark(light: str) -> str:
    """A light in HTML: its color is never alone, the word stands in it."""
    return f'<span class="{MARKS[light]}" title="{escape(LIGHTS[light])}">{escape(light)}</span>'


def section(convergence: pd.DataFrame, folded: bool = False) -> Section:
    """Whether the chains of each condition agree.

    Args:
        convergence: A row per condition, as `evaluation.convergence.beside_truth` gives them.
        folded: Whether the section is folded, as beside others.
    """
    text = render("lights.html", conditions=len(convergence), counted=counted(convergence.light), mark=mark, **LIMITS)
    parts = tuple(
        Part(
            f"diagnostics_{name}_D{D}",
            f"Chains, {name}, D = {D}",
            f"{lights_table(own)}<p>Every quantity, traces and ranks: {', '.join(_pages(own))}</p>",
        )
        for (name, D), own in convergence.groupby(["experiment", "D"], sort=False)
    )
    return Section("diagnostics", "Diagnostics", text, folded, parts)


def _pages(convergence: pd.DataFrame) -> Iterator[str]:
    """Links to the pages of the chains: one for each data set of an experiment and D."""
    for _, own in convergence.drop_duplicates(["dataset"]).iterrows():
        path = f"diagnostics/{data_set_name(own.experiment, own.dataset)}_D{own.D}.html"
        yield f'<a href="{path}">{path}</a>'


def lights_table(convergence: pd.DataFrame) -> str:
    """The lights of an experiment and D in HTML, a row per condition."""
    keys = varying(convergence, ["dataset", *(key for key in ROW_KEYS if key != "D")], "ROW", "method")
    shown = convergence[keys].rename(columns={"ROW": "ROW (%)"})
    shown["method"] = [METHODS[name].label for name in convergence.method]
    shown["light"] = convergence.light
    shown["decided by"] = [in_words(name) for name in convergence.worst]
    shown["its R-hat"] = convergence.r_hat.map(short)
    shown["R-hat of the log joint"] = convergence.log_joint_r_hat.map(short)
    shown["its effective samples"] = convergence.log_joint_ess.map(short)
    shown["chains"] = convergence.chains
    shown["nats below the truth"] = convergence.below_truth.map(nats)
    return table(shown, lambda column, value: mark(str(value)) if column == "light" else escape(str(value)))


def write_lights(convergence: pd.DataFrame, path: Path) -> None:
    """Write the page of the lights, which needs no other file."""
    write_text(path, page("Have the chains converged?", [section(convergence)]))


def in_words(quantity: str) -> str:
    """What people read instead of the name of a quantity."""
    if quantity.startswith(WORD):
        channel, _, word = quantity.removeprefix(WORD).partition("_")
        return f"share of “{word}” in {channel}"
    if quantity.startswith(FRAME):
        return f"share of words in {quantity.removeprefix(FRAME)}"
    if quantity.startswith("used_"):
        return f"categories in use, {quantity.removeprefix('used_')}"
    if quantity.startswith(MEAN_PRECISION):
        return f"κ0 of {quantity.removeprefix(MEAN_PRECISION)}"
    return quantity.replace("_", " ") or "–"


def nats(value: float) -> str:
    """A difference of log joints, a dash where there is none."""
    return "–" if np.isnan(value) else f"{round(value, 1) + 0.0:,.1f}".replace("-", "−")  # 0 is not −0


def short(value: float) -> str:
    """A number of three digits, a dash where there is none."""
    if np.isnan(value):
        return "–"
    return "∞" if np.isinf(value) else f"{value:.3g}"
