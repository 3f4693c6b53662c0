"""Have the chains of a condition mixed? A page per data set, and its figures as a table."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from data_collection.files import replacing
from evaluation.figures.chains import chains_figure
from evaluation.scores import write_csv
from evaluation.templates import simple_page
from model import METHODS, Fit
from model.data import Floats
from model.diagnostics import chain_quantities, diagnose

BURN_IN = 0.5
# Pairs of elements are too many to list: the worst one of a channel stands for all.
PAIR = "same_"


def diagnose_condition(condition: Mapping[str, Any], fits: Sequence[Fit]) -> tuple[pd.DataFrame, str]:
    """R-hat and effective sample sizes of a condition's chains, and their section of the page.

    Args:
        condition: The names of the condition, without the seed.
        fits: One per seed.
    """
    quantities = chain_quantities(fits, BURN_IN)
    table = pd.DataFrame([asdict(one) for one in diagnose(quantities)])
    table = table.astype(dict.fromkeys(table.columns.drop("quantity"), float))
    # What is the same everywhere has no ranks.
    shown = {name: draws for name, draws in quantities.items() if not name.startswith(PAIR) and np.ptp(draws) > 0}
    title = ", ".join(
        METHODS[str(value)].label if key == "method" else f"{key} {value}"
        for key, value in condition.items()
        if key != "experiment"
    )
    return table.assign(**condition)[[*condition, *table.columns]], _section(title, table, fits, shown)


def write_page(title: str, parts: Sequence[tuple[pd.DataFrame, str]], table: Path, page: Path) -> None:
    """Write the figures of all conditions as CSV and as one page that needs no other file."""
    write_csv(pd.concat([frame for frame, _ in parts]), table)
    with replacing(page) as (temporary,):
        temporary.write_text(simple_page(title, "\n".join([NOTE, *(text for _, text in parts)])), encoding="utf-8")


def _section(title: str, table: pd.DataFrame, fits: Sequence[Fit], shown: Mapping[str, Floats]) -> str:
    picture = io.BytesIO()
    chains_figure(fits, shown, title).savefig(picture, format="png", dpi=90, metadata={"Software": None})
    is_pair = table["quantity"].str.startswith(PAIR)
    channel = table["quantity"].str.removeprefix(PAIR).str.split("_").str[0]
    pairs = table[is_pair].groupby(channel[is_pair], sort=False)
    worst = pairs.agg(
        mean=("mean", "mean"), sd=("sd", "mean"), r_hat=("r_hat", "max"), ess_bulk=("ess_bulk", "min"),
        ess_tail=("ess_tail", "min"),
    )  # fmt: skip
    worst.insert(0, "quantity", [f"pairs of {name} in one category, the worst" for name in worst.index])
    rows = pd.concat([table[~is_pair], worst]).to_html(
        index=False, border=0, float_format="{:.3g}".format, na_rep="–"
    )
    image = base64.b64encode(picture.getvalue()).decode()
    return f'<h2>{title}</h2>\n<img alt="{title}" src="data:image/png;base64,{image}">\n{rows}'


NOTE = """<p>Each seed is a chain; the second half of its iterations counts. R-hat (rank-normalised, split) is near
1 where chains agree, and infinite where each stays at a value of its own; flat rank plots say the same. Where they do
not agree, a last state is a mode of the posterior that a chain has found, not a summary of it. A quantity that never
changes has no ranks and no figures (–). Conditions in which some words are omitted are missing: each of their seeds
hears other words, and has a posterior of its own.</p>"""
