"""One HTML page that needs no other file: sections with anchors, a table of contents, embedded images."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape

import pandas as pd

from evaluation.templates import render, wide

MEDIA_TYPES = {".png": "image/png", ".gif": "image/gif", ".jpg": "image/jpeg", ".svg": "image/svg+xml"}

# A cell of more characters than that is given room.
MANY, LONG = 30, ' class="long"'


@dataclass(frozen=True)
class Part:
    """A piece of a section that can be linked to.

    Attributes:
        anchor: Its name in links, unique on the page.
        title: Its heading, plain text.
        body: HTML.
        folded: Whether only its heading is seen until it is opened; a link to it opens it.
    """

    anchor: str
    title: str
    body: str
    folded: bool = False


@dataclass(frozen=True)
class Section(Part):
    """A section of the page: `body` comes before its `parts`, each of which the table of contents lists."""

    parts: tuple[Part, ...] = ()


def page(title: str, sections: Sequence[Section]) -> str:
    """The whole page; its content security policy forbids the browser to fetch anything.

    Args:
        title: Plain text.
        sections: In order.

    Raises:
        ValueError: Two sections or parts have the same anchor.
    """
    anchors = [
        anchor for section in sections for anchor in (section.anchor, *(part.anchor for part in section.parts))
    ]
    twice = sorted(anchor for anchor, count in Counter(anchors).items() if count > 1)
    if twice:
        raise ValueError(f"anchors that stand twice on the page: {', '.join(twice)}")
    return render("report.html", title=title, sections=sections)


def table(frame: pd.DataFrame, cell: Callable[[str, object], str] = lambda _, value: escape(str(value))) -> str:
    """A data frame as an HTML table.

    Args:
        frame: Its columns are the heads, in which `_` reads as a space.
        cell: Gives the HTML of a cell from its column and value; by default the value as text.
    """
    heads = "".join(f"<th>{escape(str(column).replace('_', ' '))}</th>" for column in frame.columns)
    rows = (
        "".join(
            f"<td{LONG if len(str(value)) > MANY else ''}>{cell(str(column), value)}</td>"
            for column, value in zip(frame.columns, row, strict=True)
        )
        for row in frame.itertuples(index=False, name=None)
    )
    body = "\n".join(f"<tr>{row}</tr>" for row in rows)
    return wide(f"<table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{body}\n</tbody>\n</table>")


def image(content: bytes, suffix: str, alternative: str) -> str:
    """An image as part of the page.

    Args:
        content: The bytes of its file.
        suffix: The end of the file's name, a key of `MEDIA_TYPES`.
        alternative: What is seen, for those who do not see it; plain text.
    """
    data = base64.b64encode(content).decode()
    return f'<img alt="{escape(alternative)}" src="data:{MEDIA_TYPES[suffix]};base64,{data}">'
