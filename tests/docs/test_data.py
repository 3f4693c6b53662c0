"""The page about data says what is in the files."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import model.fits
from evaluation.scores import COLUMNS
from tests.docs.pages import ROOT

PAGE = (ROOT / "docs" / "data.md").read_text(encoding="utf-8")
SECTIONS = dict(part.split("\n", 1) for part in PAGE.split("\n## ")[1:])


def code(text: str) -> list[str]:
    """What stands in backticks."""
    return re.findall(r"`([^`]+)`", text)


def test_arrays_of_a_fit_are_those_of_the_code() -> None:
    [table] = re.findall(r"(?:\|.*\n)+", model.fits.__doc__ or "")
    assert table in PAGE


def test_columns_of_the_scores() -> None:
    assert [name for name in code(SECTIONS["Scores"]) if name in COLUMNS] == COLUMNS


@pytest.mark.slow
def test_every_file_of_a_study_has_its_place(finished: Path) -> None:
    names = [name for line in PAGE.split("\n## ")[0].splitlines() if line.startswith("| `") for name in code(line)]
    folders = {name.split("/")[0] for name in names}
    for path in finished.iterdir():
        assert path.name.startswith(".") or path.name in folders, path.name


@pytest.mark.slow
def test_arrays_and_columns_are_those_of_the_files(finished: Path) -> None:
    fits = finished / "fits/simulator/default/proposed/published/D6/ROW0"
    named = re.findall(r"^\| (`.+?`) \|", SECTIONS["Fits"], flags=re.MULTILINE)
    with np.load(fits / "seed1.npz") as arrays:
        channels = arrays["channels"].tolist()
        documented = {name.format(x=channel) for row in named for name in code(row) for channel in channels}
        # The study has fits of one chain each, none of which learns κ0.
        elsewhere = ("chains_", "trace_mean_precision")
        assert set(arrays.files) == {name for name in documented if not name.startswith(elsewhere)}
    answers = pd.read_csv(Path(str(fits).replace("/fits/", "/generation/")) / "seed1" / "answers.csv")
    assert re.findall(r"^\| `(\w+)` \|", SECTIONS["Answers"], flags=re.MULTILINE) == list(answers)
    told = pd.read_csv(finished / "descriptions" / "simulator_D6.csv")
    assert list(told)[-4:] == [name for name in code(SECTIONS["Descriptions"]) if "/" not in name]
    named_here = set(code(SECTIONS["Convergence"]))
    for table in ("convergence.csv", "diagnostics.csv"):
        assert set(pd.read_csv(finished / table)) <= named_here
    scores = pd.read_csv(finished / "scores.csv")
    for task, measures in scores.groupby("task")["measure"]:
        [row] = [line for line in SECTIONS["Scores"].splitlines() if line.startswith(f"| `{task}` |")]
        assert code(row)[1:] == sorted(set(measures), key=code(row).index)
