"""HTML from the templates in this folder; values are escaped unless a template marks them as safe."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined


@cache
def _environment() -> Environment:
    return Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def render(template: str, **values: object) -> str:
    """Fill in a template.

    Args:
        template: The name of a file in this folder.
        values: What its names stand for.
    """
    return _environment().get_template(template).render(values)


def wide(content: str) -> str:
    """HTML that may be wider than the page, and then scrolls by itself."""
    return f'<div class="wide">{content}</div>'


def simple_page(title: str, body: str) -> str:
    """Give a page that needs no other file: its title is plain text, its body HTML."""
    return render("simple.html", title=title, body=body)
