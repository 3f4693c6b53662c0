"""Tables as people read them: Markdown, LaTeX and an HTML page, from the same cells."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from evaluation.templates import render, simple_page, wide


@dataclass(frozen=True)
class Grid:
    """One table of text.

    Attributes:
        caption: What it shows.
        cells: Its text; as they are shown.
        bold: Which cells are bold, by the columns that have such cells; rows as in `cells`.
        names: The ids of cells in the page, by the columns whose cells have one.
    """

    caption: str
    cells: pd.DataFrame
    bold: pd.DataFrame | None = None
    names: pd.DataFrame | None = None


@dataclass(frozen=True)
class Sheet:
    """What the files of a table hold.

    Attributes:
        title: The heading.
        grids: One or more tables; one without rows is left out.
        note: How to read them.
        data: The numbers behind them, by the ending of their file's name.
        experiment: Whose cells they are, since two experiments' are called alike.
    """

    title: str
    grids: tuple[Grid, ...]
    note: str
    data: Mapping[str, pd.DataFrame]
    experiment: str = ""

    @property
    def filled(self) -> list[Grid]:
        """The tables that have rows."""
        return [grid for grid in self.grids if len(grid.cells)]


def number(value: float, form: str = ".3f") -> str:
    """A number as people read it; a dash where there is none (NaN)."""
    return "–" if np.isnan(value) else format(value, form)


def by_measure(found: pd.DataFrame, keys: list[str], cells: Iterable[Any], names: Iterable[str]) -> pd.DataFrame:
    """A row for each combination of keys, in the order in which they are found, with a column for each measure.

    Args:
        found: Rows with the columns `keys` and `measure`.
        keys: What names a row.
        cells: What is shown of each row of `found`; a dash stands where there is none.
        names: The measures, in order.
    """
    long = found[keys].assign(measure=found["measure"], cell=list(cells))
    wide = long.pivot(index=keys, columns="measure", values="cell").reindex(columns=list(names)).astype(object)
    return found[keys].drop_duplicates(ignore_index=True).join(wide.fillna("–"), on=keys)


def files(sheet: Sheet) -> dict[str, str]:
    """The text of each file of a table, by the ending of its name."""
    fragments = "\n".join(wide(fragment(grid)) for grid in sheet.filled)
    return {
        ending: frame.to_csv(index=False, lineterminator="\n", float_format="%.6f")
        for ending, frame in sheet.data.items()
    } | {
        ".md": "\n\n".join([*(markdown(grid) for grid in sheet.filled), sheet.note]) + "\n",
        ".tex": "\n".join([*(latex(grid) for grid in sheet.filled), f"\\noindent\\small {_escape(sheet.note)}\n"]),
        ".html": simple_page(sheet.title, f"{fragments}\n<p>{html.escape(sheet.note)}</p>"),
    }


def markdown(grid: Grid) -> str:
    """A table with its caption in Markdown."""
    escaped = Grid(grid.caption, grid.cells.astype(str).map(lambda text: text.translate(_MARKDOWN)), grid.bold)
    cells = _marked(escaped, "**", "**").to_markdown(index=False, disable_numparse=True)
    return f"**{grid.caption}**\n\n{cells}"


def latex(grid: Grid) -> str:
    """A table with its caption in LaTeX (package booktabs)."""
    escaped = Grid(grid.caption, grid.cells.astype(str).map(_escape), grid.bold)
    cells = _marked(escaped, r"\textbf{", "}")
    cells.columns = pd.Index([_escape(str(column)) for column in cells.columns])
    style = cells.style.hide(axis="index")
    return str(style.to_latex(caption=_escape(grid.caption), hrules=True, column_format="l" * len(cells.columns)))


def fragment(grid: Grid, prefix: str = "", captioned: bool = True) -> str:
    """A table in HTML, without a page around it.

    Args:
        grid: The table.
        prefix: What the ids of cells begin with.
        captioned: Whether the caption is shown.
    """
    columns, nothing = grid.cells.columns, pd.DataFrame(index=grid.cells.index)
    marks = [(nothing if frame is None else frame).reindex(columns=columns) for frame in (grid.bold, grid.names)]
    rows = zip(*(frame.itertuples(index=False, name=None) for frame in (grid.cells.astype(str), *marks)), strict=True)
    cells = [list(zip(*row, strict=True)) for row in rows]
    return render("table.html", grid=grid, rows=cells, prefix=prefix, captioned=captioned)


def _marked(grid: Grid, before: str, after: str) -> pd.DataFrame:
    """The cells as text, bold ones between two marks."""
    cells = grid.cells.astype(str)
    if grid.bold is not None:
        for column in grid.bold:
            cells[column] = cells[column].where(~grid.bold[column], before + cells[column] + after)
    return cells


def _escape(text: str) -> str:
    return text.translate(_LATEX)


# Words may be of any visible characters; in the tables they are only text.
_MARKDOWN = str.maketrans({**{symbol: f"\\{symbol}" for symbol in "\\|`*[]"}, "<": "&lt;", "&": "&amp;"})
_LATEX = str.maketrans(
    {
        **{symbol: f"\\{symbol}" for symbol in "_%&#${}"},
        "\\": r"\textbackslash{}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "±": r"$\pm$",
        "−": "$-$",
        "–": "--",
    }
)
