"""The sections of a study's report that show results. All numbers come from the study's files."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path, PurePath
from typing import Any

import numpy as np
import pandas as pd

from evaluation.catalogue import ShownFigure
from evaluation.pages.page import Part, Section, image, table, wide
from evaluation.scores import ROW_KEYS, varying
from evaluation.table_forms import Sheet, fragment
from model import METHODS

PAPER = '<a href="https://doi.org/10.3389/fnbot.2017.00066">Taniguchi, Taniguchi and Cangelosi (2017)</a>'
# A larger file, as an animation may be, is linked rather than embedded.
LARGEST_IMAGE = {".gif": 1_500_000}
MARKS = {"holds": "mark yes", "does not hold": "mark no"}
# Chains are commonly said to agree up to this R-hat (Vehtari et al. 2021).
AGREE = 1.01


def about(
    config: str, origins: Mapping[str, str], scores: pd.DataFrame, dropped: Mapping[str, Sequence[str]] | None = None
) -> Section:
    """What the study is, and how large.

    Args:
        config: Name of the config file.
        origins: Where the data of each experiment come from, in words.
        scores: All scores of the study.
        dropped: By set of trials, why which were dropped; sets in which none could be are left out.
    """
    fits = scores[scores.task == "csl"].drop_duplicates(["experiment", *ROW_KEYS, "seed"])
    rows = []
    for name, origin in origins.items():
        own = fits[fits.experiment == name]
        heard = own[[METHODS[method].hears_words for method in own.method]]
        rows.append(
            {
                "experiment": name,
                "data": origin,
                "training trials (D)": _listing(own.D),
                "words omitted, % (ROW)": _listing(heard.ROW),
                "methods": ", ".join(one.label for key, one in METHODS.items() if key in set(own.method)),
                "seeds": own.seed.nunique(),
                "fits": len(own),
            }
        )
    text = (
        f"<p>A robot acts on objects and is told in short sentences what it did; from these trials alone it learns "
        f"categories of actions, positions, objects and colors, and which word belongs to which. This page shows all "
        f"that came out of the study of {PAPER} as <code>{escape(config)}</code> sets it up: {len(fits)} fits of the "
        f"model, and {len(scores)} measures of what they learned. The page is complete in itself; its links to files "
        f"lead into the folder that it was written to.</p>"
    )
    return Section("about", "What this is", text + table(pd.DataFrame(rows)) + _dropped(dropped or {}))


def _dropped(dropped: Mapping[str, Sequence[str]]) -> str:
    if not dropped:
        return ""
    gone = [{"trials": name, "dropped": len(why), "why": "; ".join(why)} for name, why in dropped.items()]
    return f"<p>Trials with an implausible number of objects were dropped.</p>{table(pd.DataFrame(gone))}"


def _listing(values: pd.Series[Any]) -> str:
    return ", ".join(str(value) for value in sorted(values.unique()))


def claims(claimed: pd.DataFrame, comparisons: pd.DataFrame, anchors: Collection[str]) -> Section:
    """The paper's claims, and which of them hold here.

    Args:
        claimed: A row per claim; all columns are shown. Those called `claim`, `verdict` and `rests_on` become anchors
            `claim_1` …, marks, and links.
        comparisons: A row per comparison on which a claim rests, likewise.
        anchors: The anchors of the page, to which links to files of their names lead.
    """

    def cell(column: str, value: object) -> str:
        text = str(value) if str(value) else "–"
        if column == "verdict":
            return f'<span class="{MARKS.get(text, "mark")}">{escape(text)}</span>'
        return _linked(text, anchors) if column == "rests_on" else escape(text)

    def cell_of_claim(column: str, value: object) -> str:
        shown = cell(column, value)
        return f'<span id="claim_{shown}">{shown}</span>' if column == "claim" else shown

    text = "<p>What the paper claims, and what this study finds. A claim that does not hold here is a finding.</p>"
    counts = claimed["verdict"].value_counts(sort=False)
    text += f"<p>Verdicts: {escape(', '.join(f'{verdict} {n}' for verdict, n in counts.items()))}.</p>"
    # The verdict must not be where only scrolling leads.
    first = ["claim", "text", "verdict"]
    text += table(claimed[[*first, *claimed.columns.drop(first)]], cell_of_claim)
    text += f"<details><summary>The {len(comparisons)} comparisons behind them</summary>"
    text += f"{table(comparisons, cell)}</details>"
    return Section("claims", "Claims of the paper", text)


def _linked(text: str, anchors: Collection[str]) -> str:
    """Names of files as links: to where the page shows them, or to the files."""
    return " ".join(_link(word, anchors) for word in text.split())


def _link(word: str, anchors: Collection[str]) -> str:
    path, _, cell = word.partition("#")
    name = PurePath(path).stem
    if name in anchors:
        return f'<a href="#{escape(f"{name}.{cell}" if cell else name)}">{escape(name)}</a>'
    return f'<a href="{escape(word)}">{escape(PurePath(path).name)}</a>' if "/" in word else escape(word)


def tables(sheets: Mapping[str, Sheet]) -> Section:
    """All tables, each with its file's name as anchor; the ids of cells begin with it, because tables share cells.

    Args:
        sheets: What the tables hold, by name.
    """
    text = "<p>Each table is also a file, for a spreadsheet or a paper.</p>"
    parts = (Part(name, sheet.title, _table(name, sheet)) for name, sheet in sheets.items())
    return Section("tables", "Tables", text, tuple(parts))


def _table(name: str, sheet: Sheet) -> str:
    # The heading says what the first caption would say again.
    shown = (wide(fragment(grid, f"{name}.", grid.caption != sheet.title)) for grid in sheet.filled)
    files = _files(f"tables/{name}.{form}" for form in ("csv", "md", "tex"))
    return "\n".join([*shown, f"<p>{escape(sheet.note)}</p>", files])


def _files(paths: Iterable[str]) -> str:
    links = (f'<a href="{escape(path)}">{escape(path)}</a>' for path in paths)
    return f'<p class="note">Files: {", ".join(links)}</p>'


def figures(shown: Iterable[ShownFigure], out: Path) -> Section:
    """All figures with their captions, each with its file's path as anchor: tables have such names, too.

    Args:
        shown: The figures.
        out: The output folder.
    """
    text = "<p>A click on a figure opens its file.</p>"
    return Section("figures", "Figures", text, tuple(_figure_part(figure, out / figure.path) for figure in shown))


def _figure_part(figure: ShownFigure, path: Path) -> Part:
    where, content = escape(figure.path), path.read_bytes()
    fits = len(content) <= LARGEST_IMAGE.get(path.suffix, len(content))
    shown = image(content, path.suffix, f"{figure.title}. {figure.caption}") if fits else where
    body = f'<figure><a href="{where}">{shown}</a><figcaption>{escape(figure.caption)}</figcaption></figure>'
    return Part(figure.path, figure.title, body)


def diagnostics(chains: Mapping[str, pd.DataFrame]) -> Section:
    """Whether the chains of each condition agree, in a few numbers.

    Args:
        chains: By the name of its file, the diagnoses of an experiment and D: a row per condition and quantity.
    """
    text = (
        f"<p>The seeds of a condition are chains of one posterior where all words, or none, are heard. R-hat "
        f"(rank-normalised, split) is near 1 where chains agree, and infinite (∞) where each stays at a value of its "
        f"own. It is taken of the log joint, the number of categories in use, whether pairs of elements share a "
        f"category, and the share of words that each channel explains; what is the same in all chains says nothing "
        f"and does not count. Where chains do not agree (R-hat above {AGREE}), a last state is a mode that a chain "
        f"has found, not a summary of the posterior.</p>"
    )
    parts = tuple(
        Part(f"diagnostics_{name}", _of_data(frame), table(_agreement(frame)) + _files([f"diagnostics/{name}.html"]))
        for name, frame in chains.items()
    )
    return Section("diagnostics", "Diagnostics", text, parts)


def _of_data(frame: pd.DataFrame) -> str:
    return f"Chains, {frame.experiment.iloc[0]}, D = {frame.D.iloc[0]}"


def _agreement(frame: pd.DataFrame) -> pd.DataFrame:
    keys = varying(frame, ROW_KEYS, "ROW", "method")
    rows = []
    for values, own in frame.groupby(keys, sort=False):
        told = own.dropna(subset=["r_hat"])
        log_joint = own.loc[own.quantity == "log_joint", "r_hat"]
        names = dict(zip(keys, values, strict=True))
        rows.append(
            {("ROW (%)" if key == "ROW" else key): value for key, value in names.items()}
            | {
                "method": METHODS[str(names["method"])].label,
                "R-hat of the log joint": _short(log_joint.max()),
                "largest R-hat": _short(told.r_hat.max()),
                f"R-hat above {AGREE}": f"{(told.r_hat > AGREE).sum()} of {len(told)}",
                "smallest effective sample size": _short(told.ess_bulk.min()),
            }
        )
    return pd.DataFrame(rows)


def _short(value: float) -> str:
    if np.isnan(value):
        return "–"
    return "∞" if np.isinf(value) else f"{value:.3g}"
