"""Tables: the numbers against plain arithmetic, and what people see."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.catalogue import TABLE_FORMS, Table, tables_of
from evaluation.scores import COLUMNS
from evaluation.tables import readable, render, select, summarise

VALUES = {
    ("proposed", 0): [0.2, 0.4, 0.9],
    ("mmlda", 0): [0.5, 0.5, 0.5],
    ("proposed", 40): [0.1, 0.3, np.nan],
    ("gmm", 100): [np.nan, np.nan, np.nan],
}
TABLE = Table("A table", "own", "csl", ("ARI_a", "EAR"), 20)


@pytest.fixture
def scores() -> pd.DataFrame:
    rows = [
        ("own", "default", "csl", method, "blocked", 1, 1, D, ROW, seed + 1, measure, value + (D == 40))
        for (method, ROW), values in VALUES.items()
        for D in (40, 20)
        for seed, value in enumerate(values)
        for measure in ("EAR", "ARI_a", "used_a")
    ]
    return pd.DataFrame(rows, columns=COLUMNS)


def test_means_and_deviations(scores: pd.DataFrame) -> None:
    summary = summarise(select(scores, TABLE), TABLE.measures)
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
    summary = summarise(select(one, TABLE), TABLE.measures)
    assert readable(summary, TABLE.measures)["EAR"].tolist() == ["0.200", "0.500", "0.100", "–"]


def test_keys_that_do_not_change_are_left_out(scores: pd.DataFrame) -> None:
    both = summarise(select(scores, Table("All", "own", "csl", ("EAR",))), ("EAR",))
    assert list(readable(both, ("EAR",)).columns) == ["D", "ROW (%)", "method", "EAR", "seeds"]
    one = summarise(select(scores, TABLE), TABLE.measures)
    assert list(readable(one, TABLE.measures).columns) == ["ROW (%)", "method", "ARI_a", "EAR", "seeds"]


class Cells(HTMLParser):
    """Collect the cells of a page's tables."""

    def __init__(self) -> None:
        super().__init__()
        self.cells: list[str] = []

    def handle_data(self, data: str) -> None:
        if data.strip():
            self.cells.append(data.strip())


def test_every_form_shows_the_same(scores: pd.DataFrame, tmp_path: Path) -> None:
    paths = {form: tmp_path / f"table.{form}" for form in TABLE_FORMS}
    render(scores, TABLE, paths)
    page = Cells()
    page.feed(paths["html"].read_text())
    assert "0.500 ± 0.361" in page.cells
    assert "0.500 ± 0.361" in paths["md"].read_text()
    assert r"0.500 $\pm$ 0.361" in paths["tex"].read_text()
    assert r"ROW (\%)" in paths["tex"].read_text()
    written = pd.read_csv(paths["csv"])
    assert written.loc[0, "EAR_sd"] == pytest.approx(0.360555)


def test_the_tables_of_a_study() -> None:
    assert set(tables_of([("simulator", "csl", 20), ("own", "csl", 5)])) == {"table_1a", "simulator_csl", "own_csl"}
