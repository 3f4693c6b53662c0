"""The page of the paper's claims: what holds on our data, and the cells that it rests on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from data_collection.files import write_text
from evaluation.claims.judging import FAILS, HOLDS, NOT_RUN, OPEN
from evaluation.convergence import AMBER, GREEN, RED, UNCHECKED
from evaluation.differences import signed
from evaluation.scores import write_csv
from evaluation.table_forms import number
from evaluation.templates import render, simple_page

LIGHT_COLOR = {RED: "#f9d5cf", AMBER: "#fdf0c8", GREEN: "#d9f0d3", UNCHECKED: "#eeeeee"}
COLOR = {HOLDS: "#d9f0d3", FAILS: "#f9d5cf", OPEN: "#fdf0c8", NOT_RUN: "#eeeeee"}


def claims_html(claims: pd.DataFrame, comparisons: pd.DataFrame) -> str:
    """The claims and their comparisons as an HTML fragment, with links that start at the output folder.

    Args:
        claims: The rows of `claims.csv`, `lights` included.
        comparisons: The rows of `claims_comparisons.csv`.
    """
    behind = [
        [_comparison(row) for _, row in comparisons[comparisons["claim"] == number].iterrows()]
        for number in claims["claim"]
    ]
    rows = list(zip(claims.to_dict("records"), behind, strict=True))
    return render("claims.html", rows=rows, color=COLOR, light=_light_color)


def _light_color(lights: str) -> str:
    """The color of the worst of some lights, as `counted` tells them."""
    return next((color for light, color in LIGHT_COLOR.items() if light in lights), "none")


def _comparison(row: pd.Series[Any]) -> dict[str, Any]:
    numbers = [number(row[name]) for name in ("left", "right")]
    spans = [signed(row["difference"]), f"{signed(row['low'])} to {signed(row['high'])}"]
    needed = "" if pd.isna(row["needed"]) else f"{row['needed']:.0f}"
    texts = [row["sampler"], row["comparison"], *numbers, *spans, row["datasets"], row["n"], needed]
    return {"texts": texts, "verdict": row["verdict"], "links": row["rests_on"].split()}


def write_claims(
    claims: pd.DataFrame, comparisons: pd.DataFrame, claims_csv: Path, rows_csv: Path, page: Path
) -> None:
    """Write the claims, their comparisons and the page of both; numbers with six digits."""
    write_csv(claims, claims_csv)
    write_csv(comparisons.round(6), rows_csv)
    write_text(page, simple_page("Claims of the paper", claims_html(claims, comparisons)))
