"""One HTML page that needs no other file: sections with anchors, a table of contents, embedded images."""

from __future__ import annotations

import base64
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from html import escape

import pandas as pd

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
    """

    anchor: str
    title: str
    body: str


@dataclass(frozen=True)
class Section:
    """A section of the page.

    Attributes:
        anchor: Its name in links, unique on the page.
        title: Its heading, plain text.
        body: HTML before the parts.
        parts: Its pieces, each of which the table of contents lists.
    """

    anchor: str
    title: str
    body: str
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
    return _PAGE.format(
        title=escape(title),
        style=_STYLE,
        contents="\n".join(line for section in sections for line in _contents(section)),
        sections="\n".join(line for section in sections for line in _section(section)),
    )


def _contents(section: Section) -> Iterator[str]:
    yield f'<li><a href="#{escape(section.anchor)}">{escape(section.title)}</a>'
    if section.parts:
        links = (f'<li><a href="#{escape(part.anchor)}">{escape(part.title)}</a></li>' for part in section.parts)
        yield f"<ol>{''.join(links)}</ol>"
    yield "</li>"


def _section(section: Section) -> Iterator[str]:
    yield f'<section id="{escape(section.anchor)}">\n<h2>{escape(section.title)}</h2>\n{section.body}'
    for part in section.parts:
        yield f'<article id="{escape(part.anchor)}">\n<h3>{escape(part.title)}</h3>\n{part.body}\n</article>'
    yield "</section>"


def wide(content: str) -> str:
    """HTML that may be wider than the page, and then scrolls by itself."""
    return f'<div class="wide">{content}</div>'


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


_STYLE = """
:root { --ink: #1f2328; --soft: #5b6470; --line: #d9dee4; --tint: #f6f8fa; --link: #0b57a4; }
* { box-sizing: border-box; }
html { scroll-padding-top: 1rem; }
body { margin: 0; color: var(--ink); background: #fff; font: 16px/1.55 system-ui, "Segoe UI", Roboto, sans-serif; }
a { color: var(--link); text-decoration: none; }
a:hover { text-decoration: underline; }
main { width: 100%; max-width: 64rem; margin: 0 auto; padding: 2rem 1.5rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 1.5rem; }
h2 { font-size: 1.4rem; margin: 3rem 0 .8rem; padding-bottom: .3rem; border-bottom: 2px solid var(--line); }
h3 { font-size: 1.08rem; margin: 2.2rem 0 .6rem; }
p { max-width: 46rem; margin: .6rem 0; }
nav { font-size: .88rem; line-height: 1.4; padding: 1.5rem; }
nav h2 { font-size: .8rem; text-transform: uppercase; letter-spacing: .06em; color: var(--soft); margin: 0 0 .6rem;
  border: 0; }
nav ol { list-style: none; margin: 0; padding: 0; }
nav li { margin: .35rem 0; }
nav ol ol { padding-left: .9rem; border-left: 1px solid var(--line); margin: .3rem 0 .6rem; }
nav ol ol a { color: var(--soft); }
.wide { overflow-x: auto; margin: .8rem 0; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .32rem .9rem .32rem .4rem; text-align: left; vertical-align: top;
  border-bottom: 1px solid var(--line); }
.long { min-width: 13rem; }
thead th { border-top: 2px solid var(--ink); border-bottom: 1px solid var(--ink); vertical-align: bottom; }
tbody tr:last-child td { border-bottom: 2px solid var(--ink); }
tbody tr:hover { background: var(--tint); }
caption { text-align: left; padding: .3rem 0; color: var(--soft); }
td:target { background: #fff1b8; }
summary { cursor: pointer; color: var(--link); }
figure { margin: 0; }
figcaption, .note, article > p, article > .wide ~ p { color: var(--soft); font-size: .9rem; }
figcaption { max-width: 46rem; margin-top: .5rem; }
img { display: block; max-width: min(100%, 54rem); border: 1px solid var(--line); border-radius: 3px; }
pre { background: var(--tint); border: 1px solid var(--line); border-radius: 3px; padding: .8rem 1rem;
  overflow-x: auto; font: .82rem/1.5 ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
code { font: .88em ui-monospace, "SF Mono", Menlo, Consolas, monospace; }
.mark { display: inline-block; padding: 0 .5em; border-radius: .8em; white-space: nowrap; background: #e8ebef; }
.mark.yes { background: #d7f0dd; color: #10561f; }
.mark.no { background: #fbdfdc; color: #86181d; }
@media (min-width: 75rem) {
  body { display: grid; grid-template-columns: 17rem minmax(0, 1fr); }
  nav { position: sticky; top: 0; height: 100vh; overflow-y: auto; border-right: 1px solid var(--line);
    background: var(--tint); }
}
@media print {
  nav { break-after: page; }
  main { max-width: none; padding: 0; }
  .wide, pre { overflow: visible; }
  pre { white-space: pre-wrap; }
  table { font-size: .75rem; }
  h2, h3 { break-after: avoid; }
  tr, figure { break-inside: avoid; }
  img { max-height: 20cm; }
}
"""

_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<nav aria-label="Contents">
<h2>Contents</h2>
<ol>
{contents}
</ol>
</nav>
<main>
<h1>{title}</h1>
{sections}
</main>
</body>
</html>
"""
