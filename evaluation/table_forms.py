"""Tables as people read them: Markdown, LaTeX and an HTML page, from the same cells."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd


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
    """

    title: str
    grids: tuple[Grid, ...]
    note: str
    data: Mapping[str, pd.DataFrame]

    @property
    def filled(self) -> list[Grid]:
        """The tables that have rows."""
        return [grid for grid in self.grids if len(grid.cells)]


def files(sheet: Sheet) -> dict[str, str]:
    """The text of each file of a table, by the ending of its name."""
    fragments = "\n".join(fragment(grid) for grid in sheet.filled)
    return {
        ending: frame.to_csv(index=False, lineterminator="\n", float_format="%.6f")
        for ending, frame in sheet.data.items()
    } | {
        ".md": "\n\n".join([*(markdown(grid) for grid in sheet.filled), sheet.note]) + "\n",
        ".tex": "\n".join([*(latex(grid) for grid in sheet.filled), f"\\noindent\\small {_escape(sheet.note)}\n"]),
        ".html": simple_page(sheet.title, f"{fragments}\n<p>{html.escape(sheet.note)}</p>"),
    }


def simple_page(title: str, body: str) -> str:
    """A page that needs no other file: its title as plain text, its body as HTML."""
    return _PAGE.format(title=html.escape(title), style=STYLE, body=body)


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
    escaped = Grid(grid.caption, grid.cells.astype(str).map(html.escape), grid.bold)
    cells = _marked(escaped, "<b>", "</b>")
    head = "".join(f"<th>{html.escape(str(column))}</th>" for column in cells.columns)
    names = grid.names if grid.names is not None else pd.DataFrame(index=cells.index)
    ids = [[names[column].iloc[row] if column in names else None for column in cells] for row in range(len(cells))]
    rows = [
        "".join(
            f'<td id="{html.escape(prefix + name)}">{text}</td>' if name else f"<td>{text}</td>"
            for name, text in zip(row_ids, row, strict=True)
        )
        for row_ids, row in zip(ids, cells.itertuples(index=False), strict=True)
    ]
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    caption = f"<caption>{html.escape(grid.caption)}</caption>\n" if captioned else ""
    return f"<table>\n{caption}<thead><tr>{head}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>"


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

STYLE = """body { font: 15px/1.5 system-ui, sans-serif; margin: 2em; color: #222; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1.5em 0; }
caption { text-align: left; font-weight: 600; padding: .4em 0; }
th, td { padding: .25em .9em; text-align: left; border-bottom: 1px solid #ddd; vertical-align: top; }
thead th { border-top: 2px solid #222; border-bottom: 1px solid #222; }
tbody tr:last-child td { border-bottom: 2px solid #222; }
img { max-width: 100%; display: block; }
td:target { background: #ffe9a8; }
p { max-width: 60em; }"""

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<style>
{style}
</style></head>
<body><h1>{title}</h1>
{body}
</body></html>
"""
