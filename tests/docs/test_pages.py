"""What the pages say is so: their commands run, their links lead somewhere, the generated page is up to date."""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.docs.pages import PAGES, ROOT, blocks, matches
from workflow.plan.reference import reference

RUN = [page for page in PAGES if any(block.runs for block in blocks(page.read_text(encoding="utf-8")))]


def name(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=name)
def test_what_a_page_says_can_be_done(page: Path, in_repository: Callable[..., str]) -> None:
    in_repository(sys.executable, "-m", "tests.docs.run_page", str(page))


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    targets = [target for target in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in target]
    for target in targets:
        file, _, anchor = target.partition("#")
        path = (page.parent / file).resolve() if file else page
        assert path.exists(), f"{page.name}: {target}"
        if anchor:
            assert anchor in anchors(path), f"{page.name}: {target}"


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_commands_in_a_sentence_exist(page: Path) -> None:
    """Every `make x` and `python -m x y` that a page mentions."""
    text = page.read_text(encoding="utf-8")
    targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), flags=re.MULTILINE)
    for target in re.findall(r"`make ([\w-]+)", text):
        assert target in targets, f"{page.name}: make {target}"
    for module in re.findall(r"python -m ([\w.]+)", text):
        path = ROOT.joinpath(*module.split("."))
        assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file() or module == "pip", module


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_a_block_that_is_not_run_says_why(page: Path) -> None:
    for block in blocks(page.read_text(encoding="utf-8")):
        if block.note.startswith("skip"):
            assert re.fullmatch(r"skip because \S.{10,}", block.note), f"{page.name}:{block.line}"


def test_pages_speak_of_no_machine() -> None:
    for page in (*PAGES, ROOT / "docs" / "example.ipynb"):
        assert not re.search(r"/(tmp|home|root|work)/", page.read_text(encoding="utf-8")), page.name


def test_every_page_is_in_the_index() -> None:
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    for page in (ROOT / "docs").iterdir():
        assert page.name == "README.md" or page.suffix in (".svg", ".png") or f"({page.name})" in index, page.name


def test_the_config_reference_is_up_to_date() -> None:
    committed = (ROOT / "docs" / "config.md").read_text(encoding="utf-8")
    assert committed == reference(), "run `make docs`"


def test_the_config_reference_has_every_key() -> None:
    page = reference()
    keys = ("averaged_draws", "temperature", "extra_degrees_of_freedom", "components", "most_objects", "saturation")
    for key in keys:
        assert re.search(rf"^- `{key}` — .+\. \*.+ by default\*$", page, re.MULTILINE), key
    row = (
        "- `ROW` — rates of omitted words in per cent. *List of 1 or more, each: whole number from 0 to 100; `[0]` by"
    )
    assert f"{row} default*" in page.splitlines()
    assert "$ref" not in page


def test_the_config_reference_can_be_read() -> None:
    """Lists instead of wide tables, nothing told twice, and an outline whose links lead to its sections."""
    page = reference()
    assert "| --- |" not in page
    assert max(map(len, page.splitlines())) < 600
    assert page.count("not beginning with =") == page.count("— sweeps per chain.") - 1 == 1  # mixing has its own
    assert "As for kind `blocked`: `chains`, `burn_in`." in page
    assert "- `action`, `position`, `object`, `color` — the words of one channel." in page


def test_the_picture_is_an_svg_that_stands_alone() -> None:
    picture = ElementTree.parse(ROOT / "docs" / "architecture.svg").getroot()
    assert picture.tag == "{http://www.w3.org/2000/svg}svg"
    assert "href" not in ElementTree.tostring(picture, encoding="unicode")


def test_blocks_notes_and_lines_are_found() -> None:
    page = "# A\n\n<!-- test: skip because it would take an hour -->\n```sh\nmake all\n```\n\n```python\n1\n2\n```\n"
    first, second = blocks(page)
    assert (first.code, first.line, first.runs, first.heading) == ("make all", 5, False, "A")
    assert (second.code, second.line, second.runs, second.note) == ("1\n2", 9, True, "")


def test_an_output_matches_only_what_was_printed() -> None:
    assert matches("a\n  b 12 c\nd\n", "b … c\nd")
    assert not matches("a\n  b 12\nc\n", "b … c")
    assert not matches("a\nb\n", "a\nc")
