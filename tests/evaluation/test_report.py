"""The report: every table, figure and claim is on it, and a browser needs nothing but the page."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from evaluation.convergence import GOAL, TOLERATED
from evaluation.figures.catalogue import FIGURES, ShownFigure, shown_figure
from evaluation.pages import causes, lights, origins, report, variance
from evaluation.pages.page import Part, Section, page
from evaluation.scores import COLUMNS
from evaluation.table_forms import Grid, Sheet
from evaluation.templates import render, simple_page
from evaluation.variance import variance_split
from tests.browser import look, needs_chromium

ROWS = pd.DataFrame({"EAR": ["0.5"]})


@pytest.fixture
def tables() -> dict[str, Sheet]:
    """A plain table, and two that show the same cell."""

    def with_cell(title: str) -> Grid:
        return Grid(title, pd.DataFrame({"ARI": ["0.25"]}), names=pd.DataFrame({"ARI": ["cell"]}))

    grids = {
        "table_1a": (Grid("Table 1A. a < b", ROWS), Grid("Nothing", ROWS[:0])),
        "table_1b": (with_cell("Table 1B"), Grid("Differences", ROWS)),
        "own_csl": (with_cell("Learning, own"),),
    }
    return {name: Sheet(own[0].caption, own, "A note.", {}) for name, own in grids.items()}


@pytest.fixture
def figures(tmp_path: Path) -> list[ShownFigure]:
    names = (
        ("words{sampler}", "own"),
        ("positions{sampler}", "own_two", "", "_mixing"),
        ("action", "own"),
        ("confusion_{method}", "own", "mmlda"),
    )
    (tmp_path / "figures").mkdir()
    shown = [shown_figure(*one) for one in names]
    for figure in shown:
        Image.new("RGB", (40, 30), "red").save(tmp_path / figure.path)
    return shown


@pytest.fixture
def claimed() -> pd.DataFrame:
    rows = [
        ("1", "A is better", "holds", "tables/table_1a.html tables/table_1b.html"),
        ("2", "B & C are", "does not hold", "tables/table_1b.html#cell descriptions/own_D5.csv own_words"),
        ("3", "nobody is", "not decidable", ""),
    ]
    return pd.DataFrame(rows, columns=["claim", "text", "verdict", "rests_on"])


@pytest.fixture
def scores() -> pd.DataFrame:
    rows = [
        (experiment, 1, "default", task, method, "published", 5, ROW, seed, measure, 0.5)
        for experiment in ("own", "own_two")
        for task, measure in (("csl", "EAR"), ("csl", "ARI_a"), ("description", "ACC"))
        for method, ROW in (("proposed", 0), ("proposed", 40), ("gmm", 100))
        for seed in (1, 2, 3)
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


LIGHTS = pd.DataFrame(
    [
        ("proposed", 0, 10, "red", "word_color_<b>_c", np.inf, 1.25, 7.25, 1234.5),
        ("proposed", 40, 4, "amber", "used_action", 1.1, 1.0, 99.0, -0.3),
        ("mmlda", 40, 1, "not checked", "", np.nan, np.nan, 20.0, np.nan),
        ("gmm", 100, 10, "green", "log_joint", 1.0, 1.0, 500.0, -0.04),
    ],
    columns=["method", "ROW", "chains", "light", "worst", "r_hat", "log_joint_r_hat", "log_joint_ess", "below_truth"],
).assign(experiment="own", dataset=1, variant="default", sampler="published", D=5)
EXPERIMENTS = ("own", "own_two")
COMPARISONS = pd.DataFrame({"comparison": ["A > B"], "verdict": ["holds"]})


@pytest.fixture
def whole(
    tables: dict[str, Sheet], figures: list[ShownFigure], claimed: pd.DataFrame, scores: pd.DataFrame, tmp_path: Path
) -> Path:
    """A report with every section."""
    sections = [
        report.about("own.yaml", dict.fromkeys(EXPERIMENTS, "simulated trials"), scores),
        report.claims(claimed, claimed, tables),
        causes.section(pd.concat([scores, scores.assign(sampler="other", value=1.0)])),
        variance.section(variance_split(scores)),
        report.tables(tables),
        report.figures(figures, tmp_path),
        lights.section(LIGHTS),
        origins.settings("own.yaml", {"own": {"words": {"color": ["rouge", "grün"]}, "K": 10}}),
        origins.versions("3.11", {"numpy": "2.0"}, {"code": "0a1b"}),
        origins.reproduction("own.yaml"),
    ]
    path = tmp_path / "report.html"
    path.write_text(page("A report", sections), encoding="utf-8")
    return path


def test_the_size_of_the_study_is_counted(scores: pd.DataFrame) -> None:
    body = report.about("own.yaml", {"own": "simulated trials", "own_two": "those of own"}, scores).body
    assert "make talk" in body
    assert f"{2 * 3 * 3} fits of the model, and {len(scores)} measures" in body
    row = ("own_two", "those of own", "5", "0, 40", "(A) proposed, ALL", "1", "3", "9")
    assert "".join(f"<td>{cell}</td>" for cell in row) in body


def test_dropped_trials_are_counted(scores: pd.DataFrame) -> None:
    dropped = {"own, train": ("trial 3: 5 objects <found>", "trial 7: 0 objects found"), "own, generation": ()}
    body = report.about("own.yaml", {"own": "a robot's logs"}, scores, dropped).body
    reasons = "trial 3: 5 objects &lt;found&gt;; trial 7: 0 objects found"
    assert re.search(rf"<td>own, train</td><td>2</td><td[^>]*>{reasons}</td>", body)
    assert "<td>own, generation</td><td>0</td>" in body
    assert "dropped" not in report.about("own.yaml", {"own": "a robot's logs"}, scores).body


def test_what_was_thrown_away_for_fair_test_sets_is_counted(scores: pd.DataFrame) -> None:
    attempts = {"own": (1, 4, 1, 2), "own_two": ()}
    body = report.about("own.yaml", {"own": "simulated trials"}, scores, attempts=attempts).body
    assert "".join(f"<td>{cell}</td>" for cell in ("own", "4", "8", "4", "50")) in body
    assert body.count("thrown away, %") == 1
    assert "own_two" not in body
    assert "thrown away" not in report.about("own.yaml", {"own": "a robot's logs"}, scores).body


def test_claims_lead_to_what_they_rest_on(claimed: pd.DataFrame) -> None:
    body = report.claims(claimed, COMPARISONS, {"table_1a", "table_1b", "own_words"}).body
    assert re.findall(r'href="(.*?)"', body) == [
        *("#table_1a", "#table_1b"),
        *("#table_1b.cell", "descriptions/own_D5.csv", "#own_words"),
    ]
    assert re.findall(r'id="(claim_.*?)"', body) == ["claim_1", "claim_2", "claim_3"]
    assert "Verdicts: holds 1, does not hold 1, not decidable 1." in body
    assert "B &amp; C are" in body


def test_the_verdict_comes_before_other_columns(claimed: pd.DataFrame) -> None:
    body = report.claims(
        claimed.assign(paper="")[["paper", "rests_on", "verdict", "text", "claim"]], COMPARISONS, ()
    ).body
    assert re.findall("<th>(.*?)</th>", body)[:6] == ["claim", "text", "verdict", "claim", "paper", "rests on"]


def test_every_table_has_its_anchor(tables: dict[str, Sheet]) -> None:
    parts = report.tables(tables).parts
    assert [part.anchor for part in parts] == ["table_1a", "table_1b", "own_csl"]
    assert parts[0].title == "Table 1A. a < b"
    assert parts[0].body.startswith('<div class="wide"><table>')
    assert "<p>A note.</p>" in parts[0].body
    assert 'href="tables/table_1a.csv"' in parts[0].body
    assert re.findall("<caption>.*?</caption>", parts[1].body) == ["<caption>Differences</caption>"]
    assert re.findall('id="(.*?)"', parts[1].body) == ["table_1b.cell"]


def test_a_table_whose_cells_all_stand_in_another_is_left_out(tables: dict[str, Sheet]) -> None:
    assert list(report.without_repeats(tables)) == ["table_1a", "table_1b"]
    of_another = Sheet("Own", tables["own_csl"].grids, "", {}, experiment="own_two")
    assert "own_csl" in report.without_repeats({**tables, "own_csl": of_another})
    more = Grid("More", pd.DataFrame({"ARI": ["0.5"]}), names=pd.DataFrame({"ARI": ["new"]}))
    grids = (*tables["own_csl"].grids, more)
    assert "own_csl" in report.without_repeats({**tables, "own_csl": Sheet("Own", grids, "", {})})


def test_main_tables_and_first_figures_are_unfolded(tables: dict[str, Sheet], figures: list[ShownFigure]) -> None:
    assert [part.folded for part in report.tables(tables).parts] == [False, False, True]
    assert [part.folded for part in report.tables({"own_csl": tables["own_csl"]}).parts] == [False]
    assert [figure.first for figure in figures] == [True, False, False, False]


def test_what_is_folded_is_seen_by_its_heading_and_opens_by_its_anchor() -> None:
    parts = (Part("open", "Open", "one"), Part("shut", "Shut", "two", folded=True))
    text = page("A report", [Section("all", "All", "", parts=parts)])
    assert re.search(r'<article id="shut">\s*<details><summary><h3>Shut</h3></summary>\s*two\s*</details>', text)
    assert re.search(r'<article id="open">\s*<h3>Open</h3>\s*one\s*</article>', text)


def test_differences_and_notes_of_a_table_are_folded(tables: dict[str, Sheet]) -> None:
    body = report.tables(tables).parts[1].body
    before, _, behind = body.partition("<details>")
    assert "table_1b.cell" in before
    assert "Differences" in behind.partition("</details>")[0]
    assert "A note." in behind.partition("</details>")[0]


def test_numbers_are_not_broken_and_all_pages_share_a_style() -> None:
    css = render("report.css")
    assert "td { white-space: nowrap; }" in css
    pages = [simple_page("A", ""), page("A", []), render("ratings.html", clips=[], title="A")]
    assert all(css.strip() in text for text in pages)


def test_figures_say_what_they_show(figures: list[ShownFigure], tmp_path: Path) -> None:
    parts = report.figures(figures, tmp_path).parts
    titles = ["Words, own", "Positions mixing, own_two", "Action, own", "Confusion mmlda, own"]
    assert [part.title for part in parts] == titles
    assert len({part.anchor for part in parts}) == len(parts)
    assert "In the paper: Figures 4A and 8A." in parts[0].body
    assert FIGURES["positions{sampler}"].caption in parts[1].body
    assert 'src="data:image/gif;base64,' in parts[2].body


def test_a_large_animation_is_linked(figures: list[ShownFigure], tmp_path: Path) -> None:
    with (tmp_path / figures[2].path).open("ab") as file:
        file.write(bytes(1_500_000))
    body = report.figures(figures, tmp_path).parts[2].body
    assert "<img" not in body
    assert '<a href="figures/own_action.gif">figures/own_action.gif</a>' in body


def test_each_condition_has_a_light_with_a_word() -> None:
    section = lights.section(LIGHTS)
    (part,) = section.parts
    assert (part.anchor, part.title) == ("diagnostics_own_D5", "Chains, own, D = 5")
    assert "Of 4 conditions: 1 red, 1 amber, 1 not checked, 1 green." in section.body
    rows = [re.findall("<td.*?>(.*?)</td>", row) for row in part.body.split("<tr>")[2:]]
    told = [[re.sub("<[^>]*>", "", cell) for cell in row] for row in rows]
    assert told == [
        ["0", "(A) proposed", "red", "share of “&lt;b&gt;_c” in color", "∞", "1.25", "7.25", "10", "1,234.5"],
        ["40", "(A) proposed", "amber", "categories in use, action", "1.1", "1", "99", "4", "−0.3"],
        ["40", "(C) mMLDA", "not checked", "–", "–", "–", "20", "1", "–"],
        ["100", "ALL", "green", "log joint", "1", "1", "500", "10", "0.0"],
    ]
    assert len({re.findall('class="(.*?)"', row[2])[0] for row in rows}) == 4
    assert 'href="diagnostics/own_D5.html"' in part.body


def test_the_rules_of_the_lights_name_each_light_and_the_thresholds(tmp_path: Path) -> None:
    lights.write_lights(LIGHTS, tmp_path / "diagnostics.html")
    text = re.sub(r"<[^>]*>", " ", (tmp_path / "diagnostics.html").read_text(encoding="utf-8"))
    for said in ("red  All else", str(GOAL), str(TOLERATED), "1.01 and 400", "Vehtari et al. (2021)", "1,000 times"):
        assert said in text


def test_two_pieces_of_one_anchor_are_refused() -> None:
    twice = Section("tables", "Tables", "", parts=(Part("a", "A", ""), Part("tables", "B", "")))
    with pytest.raises(ValueError, match=r"stand twice on the page: tables$"):
        page("A report", [twice])


def test_nothing_is_loaded_from_elsewhere(whole: Path) -> None:
    """Every address in the page is an anchor, a file beside it, or a plain link; images are part of the page."""
    text = whole.read_text(encoding="utf-8")
    assert "default-src 'none'; img-src data:" in text
    assert not re.findall(r"<(?:script|link|iframe|object|embed)|@import|url\(", text)
    assert all(source.startswith("data:") for source in re.findall(r'src="(.*?)"', text))
    elsewhere = re.findall(r'<(\w+)[^>]*?="[a-z]+://', text)
    assert set(elsewhere) == {"a"}


@needs_chromium
@pytest.mark.parametrize("window", ["1300,900", "500,900"])
def test_a_browser_shows_all_of_it(whole: Path, tmp_path: Path, window: str) -> None:
    seen = look(whole, tmp_path, window)
    assert {"table_1a", "table_1b", "own_csl", "table_1b.cell", "own_csl.cell", "claim_2"} <= set(seen.anchors)
    assert len(set(seen.anchors)) == len(seen.anchors)
    assert (seen.images, seen.broken_images, seen.silent_images) == (4, [], 0)
    assert (seen.lost_links, seen.fetched) == ([], [])
    assert seen.width <= 0


@needs_chromium
def test_the_browser_would_tell_what_is_wrong(whole: Path, tmp_path: Path) -> None:
    """The look itself: a broken image, a lost link, what is fetched, and a page that is too wide are seen."""
    text = whole.read_text(encoding="utf-8")
    text = re.sub(r'(alt="Words, own[^"]*" src="data:image/png;base64,)[^"]*', r"\1AAAA", text)
    address = "http://127.0.0.1:9/x.png"  # nobody listens there
    added = f'<a href="#nowhere">x</a><img src="{address}" style="width: 2000px; max-width: none; height: 9px">'
    text = text.replace("img-src data:", "img-src data: http:").replace("</main>", f"{added}</main>")
    whole.write_text(text, encoding="utf-8")
    seen = look(whole, tmp_path)
    assert [alternative.partition(".")[0] for alternative in seen.broken_images] == ["Words, own", ""]
    assert seen.lost_links == ["nowhere"]
    assert seen.fetched == [address]
    assert seen.silent_images == 1
    assert seen.width > 0
