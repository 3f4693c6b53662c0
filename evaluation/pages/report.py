"""The sections of a study's report that show results. All numbers come from the study's files."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path, PurePath
from typing import Any

import pandas as pd

from evaluation.catalogue import PAPER_TABLES
from evaluation.figures.catalogue import ShownFigure
from evaluation.pages.page import Part, Section, image, table
from evaluation.scores import ROW_KEYS, UNITS
from evaluation.table_forms import Sheet, fragment
from evaluation.templates import render, wide
from model import METHODS

# A larger file, as an animation may be, is linked rather than embedded.
LARGEST_IMAGE = {".gif": 1_500_000}
# What of a claim is seen at once, as far as it is told; the rest is folded.
FIRST = ("claim", "text", "verdict", "other_samplers", "ours")
MARKS = {"holds": "mark yes", "does not hold": "mark no"}


def about(
    config: str,
    origins: Mapping[str, str],
    scores: pd.DataFrame,
    dropped: Mapping[str, Sequence[str]] | None = None,
    attempts: Mapping[str, Sequence[int]] | None = None,
) -> Section:
    """What the study is, and how large.

    Args:
        config: Name of the config file.
        origins: Where the data of each experiment come from, in words.
        scores: All scores of the study.
        dropped: By set of trials, why which were dropped; sets in which none could be are left out.
        attempts: By experiment, how often each action of its fair test sets was tried.
    """
    fits = scores[scores.task == "csl"].drop_duplicates(["experiment", *ROW_KEYS, *UNITS])
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
                "data sets": own.dataset.nunique(),
                "seeds": own.seed.nunique(),
                "fits": len(own),
            }
        )
    gone = [{"trials": name, "dropped": len(why), "why": "; ".join(why)} for name, why in (dropped or {}).items()]
    tried = [
        {
            "experiment": name,
            "actions to tell about": len(own),
            "simulated": sum(own),
            "thrown away": sum(own) - len(own),
            "thrown away, %": f"{100 * (1 - len(own) / sum(own)):.0f}",
        }
        for name, own in (attempts or {}).items()
        if own
    ]
    shown = {"study": table(pd.DataFrame(rows)), "dropped": table(pd.DataFrame(gone)) if gone else ""}
    shown["tried"] = table(pd.DataFrame(tried)) if tried else ""
    counts = {"fits": len(fits), "measures": len(scores)}
    return Section("about", "What this is", render("about.html", config=config, **counts, **shown))


def _listing(values: pd.Series[Any]) -> str:
    return ", ".join(str(value) for value in sorted(values.unique()))


def claims(claimed: pd.DataFrame, comparisons: pd.DataFrame, anchors: Collection[str]) -> Section:
    """The paper's claims, and which of them hold here.

    Args:
        claimed: A row per claim; all columns are shown, those of `FIRST` unfolded. Those called `claim`, `verdict`
            and `rests_on` become anchors `claim_1` …, marks, and links.
        comparisons: A row per comparison on which a claim rests, likewise.
        anchors: The anchors of the page, to which links to files of their names lead.
    """

    def cell(column: str, value: object) -> str:
        text = str(value) if str(value) else "–"
        if column == "verdict":
            return f'<span class="{MARKS.get(text, "mark")}">{escape(text)}</span>'
        return " ".join(_link(word, anchors) for word in text.split()) if column == "rests_on" else escape(text)

    def cell_of_claim(column: str, value: object) -> str:
        shown = cell(column, value)
        return f'<span id="claim_{shown}">{shown}</span>' if column == "claim" else shown

    verdicts = ", ".join(f"{verdict} {n}" for verdict, n in claimed["verdict"].value_counts(sort=False).items())
    # The verdict must not be where only scrolling leads.
    first = [name for name in FIRST if name in claimed]
    rest = ["claim", *claimed.columns.drop(first)]
    tables = {"claims": table(claimed[first], cell_of_claim), "behind": table(claimed[rest], cell)}
    shown = {**tables, "comparisons": table(comparisons, cell), "number": len(comparisons)}
    return Section("claims", "Claims of the paper", render("claims_section.html", verdicts=verdicts, **shown))


def _link(word: str, anchors: Collection[str]) -> str:
    """The name of a file as a link: to where the page shows it, or to the file."""
    path, _, cell = word.partition("#")
    name = PurePath(path).stem
    if name in anchors:
        return f'<a href="#{escape(f"{name}.{cell}" if cell else name)}">{escape(name)}</a>'
    return f'<a href="{escape(word)}">{escape(PurePath(path).name)}</a>' if "/" in word else escape(word)


def without_repeats(sheets: Mapping[str, Sheet]) -> dict[str, Sheet]:
    """The tables without those of which every named cell stands in the ones before."""
    kept, shown = {}, set[tuple[str, str]]()
    for name, sheet in sheets.items():
        own = _cells(sheet)
        if not own or not own <= shown:
            kept[name] = sheet
        shown |= own
    return kept


def _cells(sheet: Sheet) -> set[tuple[str, str]]:
    """The names of the cells of a table; those of two experiments are called alike."""
    named = [grid.names for grid in sheet.filled if grid.names is not None]
    return {(sheet.experiment, str(name)) for names in named for column in names for name in names[column].dropna()}


def tables(sheets: Mapping[str, Sheet]) -> Section:
    """All tables, each with its file's name as anchor; the ids of cells begin with it, because tables share cells.

    Those of the paper are unfolded, and others that have scores of which no cell stands in one before.

    Args:
        sheets: What the tables hold, by name.
    """
    text = "<p>Each table is also a file, for a spreadsheet or a paper.</p>"
    of_paper, parts, shown = {name for name, *_ in PAPER_TABLES}, [], set[tuple[str, str]]()
    for name, sheet in sheets.items():
        own = _cells(sheet)
        folded = name not in of_paper and (not own or bool(own & shown))
        parts.append(Part(name, sheet.title, _table(name, sheet), folded))
        shown |= own
    return Section("tables", "Tables", text, parts=tuple(parts))


def _table(name: str, sheet: Sheet) -> str:
    """A table; its differences and how to read it are folded."""
    # The heading says what the first caption would say again.
    shown = [wide(fragment(grid, f"{name}.", grid.caption != sheet.title)) for grid in sheet.filled]
    more = "Differences, and how to read this table" if len(shown) > 1 else "How to read this table"
    behind = "\n".join([*shown[1:], f"<p>{escape(sheet.note)}</p>"])
    paths = [escape(f"tables/{name}.{form}") for form in ("csv", "md", "tex")]
    links = ", ".join(f'<a href="{path}">{path}</a>' for path in paths)
    files = f'<p class="note">Files: {links}</p>'
    return "\n".join([*shown[:1], f"<details><summary>{more}</summary>{behind}</details>", files])


def figures(shown: Iterable[ShownFigure], out: Path) -> Section:
    """All figures with their captions, each with its file's path as anchor: tables have such names, too.

    Args:
        shown: The figures.
        out: The output folder.
    """
    text = "<p>A click on a figure opens its file.</p>"
    parts = tuple(_figure_part(figure, out / figure.path) for figure in shown)
    return Section("figures", "Figures", text, parts=parts)


def _figure_part(figure: ShownFigure, path: Path) -> Part:
    where, content = escape(figure.path), path.read_bytes()
    fits = len(content) <= LARGEST_IMAGE.get(path.suffix, len(content))
    shown = image(content, path.suffix, f"{figure.title}. {figure.caption}") if fits else where
    body = f'<figure><a href="{where}">{shown}</a><figcaption>{escape(figure.caption)}</figcaption></figure>'
    return Part(figure.path, figure.title, body, folded=not figure.first)
