"""Tables: the numbers against plain arithmetic, and what people see."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.catalogue import Table, files_of_tables, tables_of
from evaluation.measures import chance_note, ranked, shown
from evaluation.rendering import write
from evaluation.scores import COLUMNS
from evaluation.tables import best, readable, select, sheet_of_scores, summarise
from tests.evaluation.hand_made import scores_of

VALUES = {
    ("proposed", 0): [0.2, 0.4, 0.9],
    ("mmlda", 0): [0.5, 0.5, 0.5],
    ("proposed", 40): [0.1, 0.3, np.nan],
    ("gmm", 100): [np.nan, np.nan, np.nan],
}
TABLE = Table("A table", "own", ("csl",), 20)
MEASURES = ("ARI_a", "EAR")


@pytest.fixture
def scores() -> pd.DataFrame:
    rows = [
        ("own", 1, "default", "csl", method, "published", D, ROW, seed + 1, measure, value + (D == 40))
        for (method, ROW), values in VALUES.items()
        for D in (40, 20)
        for seed, value in enumerate(values)
        for measure in ("EAR", "ARI_a", "used_a")
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def test_means_and_deviations(scores: pd.DataFrame) -> None:
    summary = summarise(select(scores, TABLE), MEASURES)
    assert summary[["method", "ROW"]].to_numpy().tolist() == [
        ["proposed", 0],
        ["mmlda", 0],
        ["proposed", 40],
        ["gmm", 100],
    ]
    first = summary.iloc[0]
    assert (first.EAR_mean, first.EAR_n, first.seeds) == (pytest.approx(0.5), 3, 3)
    assert first.EAR_sd == pytest.approx(np.sqrt((0.09 + 0.01 + 0.16) / 2))
    assert summary.loc[2, ["EAR_mean", "EAR_n"]].tolist() == [pytest.approx(0.2), 2]
    assert np.isnan(summary.loc[3, "EAR_mean"])
    assert summary.loc[3, "EAR_n"] == 0


def test_one_seed_has_no_deviation(scores: pd.DataFrame) -> None:
    one = scores[scores.seed == 1]
    summary = summarise(select(one, TABLE), MEASURES)
    assert readable(summary, MEASURES)["EAR"].tolist() == ["0.200", "0.500", "0.100", "–"]


def test_keys_that_do_not_change_are_left_out(scores: pd.DataFrame) -> None:
    both = summarise(select(scores, Table("All", "own", ("csl",))), ("EAR",))
    assert list(readable(both, ("EAR",)).columns) == ["D", "ROW (%)", "method", "EAR", "data sets", "seeds"]
    one = summarise(select(scores, TABLE), MEASURES)
    assert list(readable(one, MEASURES).columns) == ["ROW (%)", "method", "ARI_a", "EAR", "data sets", "seeds"]


class Cells(HTMLParser):
    """Collect the cells of a page's tables."""

    def __init__(self) -> None:
        super().__init__()
        self.cells: list[str] = []

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.cells.append(data.strip())


def test_every_form_shows_the_same(scores: pd.DataFrame, tmp_path: Path) -> None:
    write("table", sheet_of_scores(scores, TABLE), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(files_of_tables({"table": TABLE}))
    texts = {form: (tmp_path / f"table.{form}").read_text() for form in ("md", "tex", "html")}
    page = Cells()
    page.feed(texts["html"])
    assert "0.500 ± 0.361" in page.cells
    assert "0.500 ± 0.361" in texts["md"]
    assert r"0.500 $\pm$ 0.361" in texts["tex"]
    assert r"ROW (\%)" in texts["tex"]
    # The differences are below the table: of A and C at ROW 0, of which −0.3, −0.1 and +0.4 are the differences.
    assert "+0.000 ± 0.361 (p = 1.000)" in page.cells
    assert "+0.000 ± 0.361 (p = 1.000)" in texts["md"]
    written = pd.read_csv(tmp_path / "table.csv")
    assert written.loc[0, "EAR_sd"] == pytest.approx(0.360555)
    assert written["EAR_best"].tolist() == [True, True, False, False]
    assert pd.read_csv(tmp_path / "table_differences.csv")["measure"].tolist() == ["ARI_a", "EAR"]


def test_a_column_has_its_best_value_in_bold(scores: pd.DataFrame, tmp_path: Path) -> None:
    """At ROW 0 of D = 20 both have 0.5: a tie. At ROW 40 the one method has nobody to be better than."""
    write("table", sheet_of_scores(scores, TABLE), tmp_path)
    assert (tmp_path / "table.md").read_text().count("**0.500 ± 0.361**") == 2
    assert (tmp_path / "table.tex").read_text().count(r"\textbf{0.500 $\pm$ 0.000}") == 2
    assert (tmp_path / "table.html").read_text().count("<b>0.500 ± 0.361</b>") == 2
    assert "**0.200" not in (tmp_path / "table.md").read_text()
    higher = scores.assign(value=scores["value"] + (scores["method"] == "mmlda") * 0.01)
    marks = best(summarise(select(higher, TABLE), MEASURES), MEASURES)
    assert marks["EAR"].tolist() == [False, True, False, False]


def test_n_is_told_where_a_seed_does_not_define_the_measure(scores: pd.DataFrame) -> None:
    shown = readable(summarise(select(scores, TABLE), MEASURES), MEASURES)
    assert shown["EAR"].tolist()[2:] == ["0.200 ± 0.141 (n = 2)", "–"]
    assert "n =" not in shown["EAR"][0]


def test_chance_stands_beside_its_measure() -> None:
    values = {("generation", "proposed", 40, 0, m): v for m, v in (("OAR", [1.0, 0.5]), ("OAR_chance", [0.4, 0.4]))}
    summary = summarise(scores_of(values), ("WAR", "OAR"))
    shown = readable(summary, ("WAR", "OAR"))
    assert list(shown.columns) == ["ROW (%)", "method", "WAR", "OAR", "OAR by chance", "data sets", "seeds"]
    assert shown.iloc[0].tolist()[2:] == ["–", "0.750 ± 0.354", "0.400", 1, 2]


def test_measures_that_do_not_rank_are_neither_marked_nor_compared() -> None:
    assert ranked(("EAR", "word_entropy", "EAR_low", "used_a", "EAR_mode")) == ("EAR", "EAR_mode")


def test_an_optional_measure_is_shown_where_some_fit_defines_it(scores: pd.DataFrame) -> None:
    mode = scores[scores["measure"] == "EAR"].assign(measure="EAR_mode")
    for more, expected in ((mode, True), (mode.assign(value=np.nan), False)):
        sheet = sheet_of_scores(pd.concat([scores, more], ignore_index=True), TABLE)
        assert ("EAR_mode" in sheet.grids[0].cells) is expected
        assert ("EAR_mode_best" in sheet.data[".csv"]) is expected
        assert "EAR" in sheet.grids[0].cells


def test_table_5_shows_both_tasks(tmp_path: Path) -> None:
    tables = tables_of([("real", "description", 25), ("real", "description", 40), ("real", "generation", 25)])
    assert shown(tables["table_5"].tasks) == ("F1", "ACC", "WAR", "OAR")
    scores = scores_of(
        {
            ("description", "proposed", 25, 0, "F1"): [0.1, 0.3],
            ("description", "proposed", 40, 0, "F1"): [0.4, 0.4],
            ("generation", "proposed", 25, 0, "OAR"): [1.0, 1.0],
        },
        "real",
    )
    write("table_5", sheet_of_scores(scores, tables["table_5"]), tmp_path)
    written = pd.read_csv(tmp_path / "table_5.csv")
    assert written[["D", "F1_mean", "seeds"]].to_numpy().tolist() == [[25, 0.2, 2], [40, 0.4, 2]]
    assert written["OAR_n"].tolist() == [2, 0]


def test_a_table_shows_the_tasks_that_are_run() -> None:
    assert shown(tables_of([("real", "generation", 25)])["table_5"].tasks) == ("WAR", "OAR")


def test_a_variant_of_one_figure_is_in_the_experiments_table_only(tmp_path: Path) -> None:
    usual = scores_of({("csl", "proposed", 25, 9, "EAR"): [0.5, 0.7]}, "real")
    scores = pd.concat([usual, usual.assign(variant="few")], ignore_index=True)
    tables = tables_of([("real", "csl", 25)], {"real": ["few"]})
    for name, variants in (("table_4", ["default"]), ("real_csl", ["default", "few"])):
        write(name, sheet_of_scores(scores, tables[name]), tmp_path)
        assert pd.read_csv(tmp_path / f"{name}.csv")["variant"].tolist() == variants
    # With one variant left, nothing has to say which it is.
    assert "variant" not in (tmp_path / "table_4.md").read_text()


def test_the_tables_of_a_study() -> None:
    tables = tables_of([("simulator", "csl", 20), ("own", "csl", 5), ("own", "uncertain", 5)])
    assert set(tables) == {"table_1a", "simulator_csl", "own_csl", "own_uncertain"}
    assert "own_uncertain_differences.csv" not in files_of_tables(tables)


def test_titles_tell_the_one_number_of_trials() -> None:
    tables = tables_of([("simulator", "csl", 20), ("simulator", "csl", 40), ("simulator", "generation", 40)])
    assert {name: table.title for name, table in tables.items()} == {
        "table_1a": "Table 1A. Learning, simulator, D = 20",
        "table_1b": "Table 1B. Learning, simulator, D = 40",
        "table_2": "Table 2. Action generation, simulator, D = 40",
        "simulator_csl": "Learning, simulator",
        "simulator_generation": "Action generation, simulator, D = 40",
    }


def test_a_note_tells_the_chance_of_the_measures_that_are_shown() -> None:
    assert chance_note(("EAR", "F1")) == ""
    assert chance_note(("WAR", "OAR")).startswith("Chance: of WAR, an action")
    assert "of ACC, a word of the right channel at random" in chance_note(("F1", "ACC"))
