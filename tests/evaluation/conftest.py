"""A fit of a small data set with known truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from features.table import FeatureTable, read_table
from model import Blocked, Fit, Problem, Trials, fit
from tests.synthetic import OBJECTS_COLUMNS, TRIALS_COLUMNS, own_rows, write_rows


@pytest.fixture(scope="session")
def table(tmp_path_factory: pytest.TempPathFactory) -> FeatureTable:
    folder = tmp_path_factory.mktemp("table")
    trials, objects = own_rows(trials=12, object_dimension=6, action_dimension=5)
    write_rows(trials, TRIALS_COLUMNS, folder / "trials.parquet")
    write_rows(objects, OBJECTS_COLUMNS, folder / "objects.parquet")
    return read_table(folder / "trials.parquet", folder / "objects.parquet", need_attention=True)


def fit_of(table: FeatureTable, method: str, words: bool = True) -> Fit:
    """A short fit of the table."""
    trials = Trials.from_arrays(**table.learning_input())
    if not words:
        trials = trials.keep_words(np.zeros(len(trials.word_trial), dtype=bool))
    return fit(Problem.of(trials, method), Blocked(iterations=15), np.random.default_rng(2))


@pytest.fixture(scope="session")
def proposed(table: FeatureTable) -> Fit:
    return fit_of(table, "proposed")


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path
