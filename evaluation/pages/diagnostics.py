"""Have the chains of a condition mixed? A page per experiment and D, and its figures as a table."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from data_collection.files import write_text
from evaluation.convergence import light_of
from evaluation.figures.chains import chains_figure
from evaluation.pages.page import image
from evaluation.scores import write_csv
from evaluation.templates import simple_page
from model import METHODS, Fit
from model.data import Floats
from model.diagnostics import PAIR, WORD, Diagnosis, chain_quantities, diagnose

# Too many to list: of each channel the worst one stands for all.
MANY = {PAIR: "pairs of {} in one category, the worst", WORD: "share of a word in {}, the worst"}


def diagnose_condition(condition: Mapping[str, Any], fits: Sequence[Fit]) -> tuple[pd.DataFrame, str]:
    """R-hat and effective sample sizes of a condition's chains, and their section of the page.

    Args:
        condition: The names of the condition, without the seed.
        fits: One per chain.
    """
    quantities = chain_quantities(fits)
    found = diagnose(quantities)
    if fits[0].history is None and fits[0].problem.method.has_frames and len(fits[0].trials.word_trial):
        unknown = float("nan")
        found.append(Diagnosis("words", unknown, unknown, None, None, None, len(fits), 0))
    numbers = ["mean", "sd", "r_hat", "ess_bulk", "ess_tail"]
    table = pd.DataFrame([asdict(one) for one in found]).astype(dict.fromkeys(numbers, float))
    # What is the same everywhere has no ranks.
    shown = {name: draws for name, draws in quantities.items() if not name.startswith((*MANY,)) and np.ptp(draws) > 0}
    title = ", ".join(
        METHODS[str(value)].label if key == "method" else f"{key} {value}"
        for key, value in condition.items()
        if key not in ("experiment", "dataset")  # which the title of the page tells
    )
    return table.assign(**condition)[[*condition, *table.columns]], _section(title, table, fits, shown)


def write_page(title: str, parts: Sequence[tuple[pd.DataFrame, str]], table: Path, page: Path) -> None:
    """Write the figures of all conditions as CSV and as one page that needs no other file."""
    write_csv(pd.concat([frame for frame, _ in parts]), table)
    write_text(page, simple_page(title, "\n".join([NOTE, *(text for _, text in parts)])))


def _section(title: str, table: pd.DataFrame, fits: Sequence[Fit], shown: Mapping[str, Floats]) -> str:
    picture = io.BytesIO()
    chains_figure(fits, shown, title).savefig(picture, format="png", dpi=90, metadata={"Software": None})
    is_listed = ~table["quantity"].str.startswith((*MANY,))
    rows = pd.concat([table[is_listed], *(_worst(table, prefix) for prefix in MANY)]).to_html(
        index=False, border=0, float_format="{:.3g}".format, na_rep="–"
    )
    light = light_of(table)["light"]
    return f"<h2>{title}: {light}</h2>\n{image(picture.getvalue(), '.png', title)}\n{rows}"


def _worst(table: pd.DataFrame, prefix: str) -> pd.DataFrame:
    """Of quantities of one kind a row for each channel: the worst of them, and the mean of their means."""
    own = table[table["quantity"].str.startswith(prefix)]
    channel = own["quantity"].str.removeprefix(prefix).str.split("_").str[0]
    worst = own.groupby(channel, sort=False).agg(
        mean=("mean", "mean"), sd=("sd", "mean"), r_hat=("r_hat", "max"), ess_bulk=("ess_bulk", "min"),
        ess_tail=("ess_tail", "min"), chains=("chains", "first"), draws=("draws", "first"),
    )  # fmt: skip
    worst.insert(0, "quantity", [MANY[prefix].format(name) for name in worst.index])
    return worst


NOTE = """<p>Each line and each row of a rank plot is a chain; what comes after its burn-in counts. R-hat
(rank-normalised, split) is near 1 where chains agree, and infinite where each stays at a value of its own; flat rank
plots say the same. A quantity that never changes has no ranks and no figures (–).
<a href="../diagnostics.html">What the lights mean</a></p>"""
