"""Fonts of figures: words of any script are shown where a font has them, and told once where none has."""

from __future__ import annotations

import io
import warnings
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib import font_manager
from matplotlib.figure import Figure

from evaluation.figures.fonts import COMMON, advice, every_script, fallbacks

FONTS = Path(mpl.get_data_path()) / "fonts" / "ttf"
# A character that one font of matplotlib's own has, and the common one lacks.
OWN, OTHER = "\u1d81", str(FONTS / "STIXGeneral.ttf")


def drawn(*words: str) -> Figure:
    figure = Figure()
    for i, word in enumerate(words):
        figure.text(0.1, 0.1 + 0.2 * i, word)
    return figure


def fonts_of_the_machine(monkeypatch: pytest.MonkeyPatch, *paths: str) -> None:
    monkeypatch.setattr(font_manager, "findSystemFonts", lambda: list(paths))


def test_a_font_that_has_a_character_is_found(tmp_path: Path) -> None:
    broken = tmp_path / "broken.ttf"
    broken.write_bytes(b"no font")
    families, left = fallbacks({OWN, "日"}, [str(broken), OTHER])
    assert (families, left) == (["STIXGeneral"], {"日"})


def test_one_warning_tells_all_that_no_font_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    fonts_of_the_machine(monkeypatch)
    figure = drawn("赤", "青", "カップ")
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        with every_script(figure):
            figure.savefig(io.BytesIO(), format="png")
    assert len(told) == 1
    assert all(part in str(told[0].message) for part in ("赤", "青", "カ", "apt install fonts-noto-cjk)"))


def test_texts_that_the_common_font_shows_keep_it(monkeypatch: pytest.MonkeyPatch) -> None:
    fonts_of_the_machine(monkeypatch, OTHER)
    figure = drawn("cup grün чашка", OWN)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with every_script(figure):
            pass
    assert [text.get_fontfamily() for text in figure.texts] == [
        mpl.rcParams["font.family"],
        [COMMON, "STIXGeneral"],
    ]


def test_words_along_an_axis_have_the_font_too(monkeypatch: pytest.MonkeyPatch) -> None:
    fonts_of_the_machine(monkeypatch, OTHER)
    figure = Figure()
    axes = figure.subplots()
    axes.set_xticks([0, 1], ["cup", OWN])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with every_script(figure):
            figure.savefig(io.BytesIO(), format="png")
    assert [label.get_fontfamily()[-1] for label in axes.get_xticklabels()] == ["sans-serif", "STIXGeneral"]


def test_advice_names_a_package_for_each_script() -> None:
    assert "fonts-noto-cjk fonts-noto-core" in advice({"컵", "ක"})
    assert "and 5 more" in advice({chr(0x4E00 + i) for i in range(25)})
