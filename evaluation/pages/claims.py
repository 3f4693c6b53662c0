"""The page of the paper's claims: what holds on our data, and the cells that it rests on."""

from __future__ import annotations

import html
from pathlib import Path
from typing import Any

import pandas as pd

from data_collection.files import replacing
from evaluation.claims.judging import FAILS, HOLDS, NOT_RUN, OPEN
from evaluation.differences import signed
from evaluation.scores import write_csv
from evaluation.table_forms import simple_page

COLOR = {HOLDS: "#d9f0d3", FAILS: "#f9d5cf", OPEN: "#fdf0c8", NOT_RUN: "#eeeeee"}
RULES = (
    "Each claim is a list of comparisons, all of which must hold. The point estimate over the seeds decides a "
    "comparison; it is not decidable where the 95 % bootstrap interval of the difference over the seeds contains the "
    "bound (percentiles of 10,000 samples; seeds are paired within one D, where they share the omitted words; where "
    "every seed gives the same difference the point estimate alone decides; one seed alone decides nothing). One "
    "comparison that does not hold refutes a claim; else one that was not run leaves it not run; else one that is "
    "not decidable leaves it so. There is no correction for the number of comparisons, so the more a claim has, the "
    "sooner one fails by chance. The seeds share one data set: another could change a verdict. The claims are about "
    "the paper's algorithm: the sampler “published” and the variant “default” of the config."
)


def claims_html(claims: pd.DataFrame, comparisons: pd.DataFrame) -> str:
    """The claims and their comparisons as an HTML fragment, with links that start at the output folder.

    Args:
        claims: The rows of `claims.csv`.
        comparisons: The rows of `claims_comparisons.csv`.
    """
    head = "".join(f"<th>{name}</th>" for name in ("", "claim", "experiment", "paper", "ours", "verdict"))
    rows = [_claim(claim, comparisons[comparisons["claim"] == claim["claim"]]) for _, claim in claims.iterrows()]
    body = "\n".join(rows)
    files = ", ".join(f'<a href="{name}">{name}</a>' for name in ("claims.csv", "claims_comparisons.csv"))
    table = f'<table class="claims">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table>'
    return f"<p>{RULES} As data: {files}.</p>\n{table}"


def write_claims(
    claims: pd.DataFrame, comparisons: pd.DataFrame, claims_csv: Path, rows_csv: Path, page: Path
) -> None:
    """Write the claims, their comparisons and the page of both; numbers with six digits."""
    write_csv(claims, claims_csv)
    write_csv(comparisons.round(6), rows_csv)
    with replacing(page) as (temporary,):
        temporary.write_text(simple_page("Claims of the paper", claims_html(claims, comparisons)), encoding="utf-8")


def _claim(claim: pd.Series[Any], comparisons: pd.DataFrame) -> str:
    note = f"<p>{html.escape(claim['note'])}</p>" if claim["note"] else ""
    details = "\n".join(_comparison(row) for _, row in comparisons.iterrows())
    head = "".join(f"<th>{name}</th>" for name in ("comparison", "left", "right", "difference", "95 %", "n", "", ""))
    texts = "".join(f"<td>{html.escape(claim[name])}</td>" for name in ("experiment", "paper", "ours"))
    return (
        f'<tr id="claim-{claim["claim"]}"><td>{claim["claim"]}</td><td>{html.escape(claim["text"])}{note}</td>'
        f"{texts}{_verdict(claim['verdict'])}</tr>\n"
        f'<tr><td></td><td colspan="5"><details><summary>comparisons: {len(comparisons)}</summary>\n'
        f"<table><thead><tr>{head}</tr></thead><tbody>\n{details}\n</tbody></table></details></td></tr>"
    )


def _comparison(row: pd.Series[Any]) -> str:
    numbers = ["–" if pd.isna(row[name]) else f"{row[name]:.3f}" for name in ("left", "right")]
    spans = [" to ".join(signed(row[name]) for name in names) for names in (("difference",), ("low", "high"))]
    links = " ".join(f'<a href="{html.escape(link)}">{i}</a>' for i, link in enumerate(row["rests_on"].split(), 1))
    cells = "".join(f"<td>{text}</td>" for text in (html.escape(row["comparison"]), *numbers, *spans, row["n"]))
    return f"<tr>{cells}{_verdict(row['verdict'])}<td>{links and 'cells '}{links}</td></tr>"


def _verdict(verdict: str) -> str:
    return f'<td style="background: {COLOR[verdict]}">{verdict}</td>'
