"""The page of the chains: every condition, its figures, and what they say of chains that agree and that do not."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from evaluation.figures.chains import chains_figure
from evaluation.pages.diagnostics import diagnose_condition, write_page
from features.table import FeatureTable
from model import Blocked, Fit, Problem, Trials, fit

CONDITION = {"experiment": "own", "method": "proposed", "D": 12, "ROW": 0}


def chains(table: FeatureTable) -> list[Fit]:
    """Three chains of one posterior."""
    problem = Problem.of(Trials.from_arrays(**table.learning_input()), "proposed")
    return [fit(problem, Blocked(iterations=40), np.random.default_rng(i)) for i in range(3)]


def test_the_page_shows_every_condition(table: FeatureTable, tmp_path: Path) -> None:
    fits = chains(table)
    parts = [diagnose_condition(CONDITION | {"D": D}, fits) for D in (12, 20)]
    write_page("Chains", parts, tmp_path / "chains.csv", tmp_path / "chains.html")
    page = (tmp_path / "chains.html").read_text()
    assert re.findall(r"<h2>(.*?)</h2>", page) == [f"(A) proposed, D {D}, ROW 0: red" for D in (12, 20)]
    for picture in re.findall(r"base64,([^\"]+)", page):
        assert base64.b64decode(picture).startswith(b"\x89PNG")
    assert "pairs of object in one category, the worst" in page
    assert "None" not in page
    written = pd.read_csv(tmp_path / "chains.csv")
    assert set(written["D"]) == {12, 20}
    assert {"log_joint", "used_action", "frame_color", "word_color_red"} <= set(written["quantity"])
    assert "share of a word in color, the worst" in page
    assert "word_color_red" not in page


def test_words_that_no_state_tells_of_are_a_quantity_that_is_not_known(table: FeatureTable) -> None:
    fits = chains(table)
    for kept, unknown in ((fits, 0), ([replace(one, history=None) for one in fits], 1)):
        found, _ = diagnose_condition(CONDITION, kept)
        words = found[found["quantity"] == "words"]
        assert len(words) == unknown
        assert words["r_hat"].isna().all()
    for problem in (
        Problem.of(Trials.from_arrays(**table.learning_input()), "mmlda"),
        Problem.of(fits[0].trials.keep_words(np.zeros(len(fits[0].trials.word_trial), dtype=bool)), "proposed"),
    ):
        silent = replace(fit(problem, Blocked(iterations=8), np.random.default_rng(0)), history=None)
        assert "words" not in diagnose_condition(CONDITION, [silent])[0]["quantity"].tolist()


def test_chains_that_stay_apart_are_told(table: FeatureTable) -> None:
    fits = chains(table)
    apart = [replace(one, trace_log_joint=one.trace_log_joint + 1000.0 * i) for i, one in enumerate(fits)]
    tables = [diagnose_condition(CONDITION, group)[0].set_index("quantity") for group in (fits, apart)]
    r_hat = [float(found["r_hat"]["log_joint"]) for found in tables]
    assert r_hat[1] > max(r_hat[0], 2.0)


def test_a_panel_for_each_quantity(table: FeatureTable) -> None:
    fits = chains(table)
    draws = {f"quantity {i}": np.random.default_rng(i).normal(size=(3, 20)) for i in range(6)}
    titles = [axes.get_title() for axes in chains_figure(fits, draws, "title").axes]
    assert titles[1:7] == [f"ranks of quantity {i}" for i in range(6)]
