"""Fonts for words of any script: those of the machine that have what the common font lacks."""

from __future__ import annotations

import unicodedata
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache

from matplotlib import font_manager
from matplotlib.figure import Figure
from matplotlib.text import Text

COMMON = "DejaVu Sans"
"""The font of all figures; it comes with matplotlib, so that every machine draws the same."""
_CJK = ("CJK", "HIRAGANA", "KATAKANA", "KATAKANA-HIRAGANA", "HANGUL", "IDEOGRAPHIC", "FULLWIDTH", "HALFWIDTH")


@contextmanager
def every_script(figure: Figure) -> Iterator[None]:
    """Give the texts of a figure fonts for what the common one lacks; within the block nothing else warns of glyphs.

    A figure whose texts the common font can show stays as it is. What no font of the machine can show is told in one
    warning, with a package that has such a font.
    """
    texts = figure.findobj(Text)
    missing = _lacking("".join(text.get_text() for text in texts))
    if missing:
        families, unshown = fallbacks(missing, sorted(font_manager.findSystemFonts()))
        for text in texts:
            if set(text.get_text()) & missing:
                text.set_fontfamily([COMMON, *families])
        if unshown:
            warnings.warn(advice(unshown), stacklevel=3)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        yield


def fallbacks(missing: Iterable[str], paths: Sequence[str]) -> tuple[list[str], set[str]]:
    """Families that have characters, each taken for what those before it lack.

    Args:
        missing: The characters.
        paths: Font files, in the order in which they are tried; one that cannot be read is passed over.

    Returns:
        The families, known to matplotlib from then on, and the characters that none has.
    """
    families, left = [], set(missing)
    for path in paths:
        if not left:
            break
        found = {char for char in left if ord(char) in _characters(path)}
        if found:
            font_manager.fontManager.addfont(path)
            families.append(font_manager.FontProperties(fname=path).get_name())
            left -= found
    return families, left


def advice(unshown: Iterable[str]) -> str:
    """What no font shows, and which packages help."""
    chars = sorted(unshown)
    scripts = {unicodedata.name(char, "UNKNOWN").split()[0] for char in chars}
    packages = {"fonts-noto-cjk" if script in _CJK else "fonts-noto-core" for script in scripts}
    shown = "".join(chars[:20]) + (f" and {len(chars) - 20} more" if len(chars) > 20 else "")
    return (
        f"no font of this machine shows {shown}, so that figures have boxes in their place; "
        f"install one (Debian: apt install {' '.join(sorted(packages))}) and draw the figures again"
    )


def _lacking(text: str) -> set[str]:
    """The visible characters of a text that the common font does not have."""
    known = _characters(font_manager.findfont(COMMON))
    return {char for char in text if ord(char) not in known and char.isprintable() and not char.isspace()}


@cache
def _characters(path: str) -> frozenset[int]:
    """The code points that a font file has; none where it cannot be read."""
    try:
        return frozenset(font_manager.get_font(path).get_charmap())
    except (OSError, RuntimeError):
        return frozenset()
