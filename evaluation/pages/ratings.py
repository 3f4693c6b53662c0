"""The page on which people rate clips; it needs no server, and saves the filled-in form as CSV."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from data_collection.files import write_text
from evaluation.templates import render


def write_page(clips: Sequence[tuple[str, str, Sequence[str]]], title: str, path: Path) -> None:
    """Write the page.

    Args:
        clips: Name, path of the picture relative to the page, and allowed words of each clip.
        title: Heading of the page.
        path: The page.
    """
    write_text(path, render("ratings.html", clips=clips, title=title))
