"""Words of any visible characters are only text in tables, pages, forms and figures."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pandas as pd
import pytest

from data_collection.limits import is_word
from evaluation.figures.drawing import save_figure
from evaluation.figures.fit import word_distributions
from evaluation.pages.page import table
from evaluation.ratings import write_page
from evaluation.scores import write_csv
from evaluation.table_forms import Grid, Sheet, files
from model import Fit

WORDS = (
    "<script>alert(1)</script>", "<img/src=x/onerror=alert(1)>", "a&amp;b", '"onload="x"', "'x'", "a|b",
    r"\end{tabular}", r"\input{/etc/passwd}", "$x$", r"$\frac$", "50%", "#1", "{x}", "{title}", "$title", "~", "^",
    "`rm`", "*b*", "[a](b)", "a,b", "a;b", "--", "日本", "écarlate", "😀",
)  # fmt: skip
TAGS = {
    "html",
    "head",
    "meta",
    "title",
    "style",
    "body",
    "h1",
    "table",
    "caption",
    "thead",
    "tbody",
    "tr",
    "th",
    "td",
}
ALLOWED = tuple(word for word in WORDS if is_word(word))


class Reader(HTMLParser):
    """Gathers the tags of a page, its cells and the values of its inputs."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.texts: list[str] = []
        self.values: list[str | None] = []
        self.attributes: set[str] = set()
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes |= {name for name, _ in attrs}
        self.values += [value for name, value in attrs if name == "value"]

    def handle_data(self, data: str) -> None:
        self.texts.append(data.strip())


def grid(words: tuple[str, ...] = WORDS) -> Grid:
    cells = pd.DataFrame({"word": words, "number": ["1"] * len(words)})
    return Grid("Words", cells, bold=pd.DataFrame({"word": [i % 2 == 0 for i in range(len(words))]}))


SHEET = Sheet("Title", (grid(),), "note", {})


def test_the_page_of_a_table() -> None:
    page = Reader(files(SHEET)[".html"])
    assert set(page.tags) <= TAGS | {"b", "div", "main", "p"}
    assert [text for text in page.texts if text in WORDS] == list(WORDS)
    inner = Reader(table(grid().cells))
    assert "script" not in inner.tags
    assert [text for text in inner.texts if text in WORDS] == list(WORDS)


def test_markdown() -> None:
    lines = files(SHEET)[".md"].splitlines()
    rows = [line for line in lines if line.startswith("|")][2:]
    assert len(rows) == len(WORDS)
    for word, row in zip(WORDS, rows, strict=True):
        bare = re.sub(r"\\[\\|`*\[\]]", "", row)  # what is escaped stands for itself
        assert bare.count("|") == 3
        assert not set("<`[]") & set(bare)
        shown = re.sub(r"\\(.)", r"\1", row.split("| 1 ")[0][2:].strip().strip("*")) if "*" not in word else None
        assert shown is None or shown.replace("&lt;", "<").replace("&amp;", "&") == word


def test_latex() -> None:
    lines = files(SHEET)[".tex"].splitlines()
    rows = [line for line in lines if line.endswith(r"& 1 \\")]
    assert len(rows) == len(WORDS)
    for row in rows:
        cell = row.removesuffix(r" & 1 \\")
        cell = cell.removeprefix(r"\textbf{").removesuffix("}") if cell.startswith(r"\textbf{") else cell
        bare = re.sub(r"\\(textbackslash|textasciitilde|textasciicircum)\{\}|\\[_%&#${}]", "", cell)
        assert not set("\\_%&#${}~^") & set(bare), cell


def test_the_form_for_raters(tmp_path: Path) -> None:
    write_page([("clip_001", "clips/clip_001.gif", WORDS)], "Title", tmp_path / "form.html")
    page = Reader((tmp_path / "form.html").read_text(encoding="utf-8"))
    assert page.values == list(WORDS)
    assert page.tags.count("script") == 1
    assert page.tags.count("img") == 1
    assert not any(name.startswith("on") for name in page.attributes)


def test_csv_gives_every_word_back(tmp_path: Path) -> None:
    frame = pd.DataFrame({"word": ALLOWED, "other": ALLOWED[::-1]})
    write_csv(frame, tmp_path / "words.csv")
    pd.testing.assert_frame_equal(pd.read_csv(tmp_path / "words.csv"), frame)
    assert not any(line.lstrip('"')[:1] in "=+-@" for line in (tmp_path / "words.csv").read_text().splitlines())


@pytest.mark.filterwarnings("ignore:Glyph")
def test_figures(proposed: Fit, tmp_path: Path) -> None:
    vocabulary = proposed.trials.vocabulary
    words = (*(WORDS * 2)[: len(vocabulary) - 2], r"$\frac$", "$$")
    trials = replace(proposed.trials, vocabulary=words)
    hostile = replace(proposed, problem=replace(proposed.problem, trials=trials))
    figure = word_distributions(hostile, {"action": words[:3]}, r"$\title$")
    save_figure(figure, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 1000
