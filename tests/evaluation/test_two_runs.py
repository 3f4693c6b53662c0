"""Two runs: what their seeds explain, and what not."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.scores import write_csv
from evaluation.two_runs import compare
from tests.evaluation.hand_made import scores_of
from workflow.artifacts.provenance import ROOT

MEASURES = tuple(f"ARI_{x}" for x in "apoc")


def run(seed: int, shift: float = 0.0) -> pd.DataFrame:
    """Ten seeds of sixteen cells, of which `shift` moves one by that many standard deviations."""
    rng = np.random.default_rng(seed)
    values = {("csl", "proposed", D, 0, m): list(rng.normal(0.5, 0.1, 10)) for D in range(20, 24) for m in MEASURES}
    values["csl", "proposed", 22, 0, "ARI_o"] = [v + 0.1 * shift for v in values["csl", "proposed", 22, 0, "ARI_o"]]
    return scores_of(values)


def verdicts(results: pd.DataFrame, reference: pd.DataFrame) -> dict[str, int]:
    counts = compare(results, reference).cells["verdict"].value_counts()
    return {str(verdict): int(count) for verdict, count in counts.items()}


def test_a_run_is_the_same_as_itself() -> None:
    assert verdicts(run(1), run(1)) == {"the same": 16}
    assert compare(run(1), run(1)).explained


def test_other_seeds_are_explained() -> None:
    """At a rate of 5 %, of 40 comparisons of two equal runs few raise an alarm."""
    alarms = sum(not compare(run(2 * i), run(2 * i + 1)).explained for i in range(40))
    assert alarms <= 6


def test_a_shift_is_found_and_named() -> None:
    compared = compare(run(1, shift=4.0), run(2))
    assert verdicts(run(1, shift=4.0), run(2)) == {"differs": 1, "explained by the seeds": 15}
    assert not compared.explained
    assert "simulator default published csl D 22 ROW 0 proposed ARI_o: " in compared.summary()


def cell(values: list[float]) -> pd.DataFrame:
    return scores_of({("csl", "proposed", 20, 0, "EAR"): values})


@pytest.mark.parametrize(
    ("results", "reference", "expected"),
    [
        ([1.0, 1.0], [0.9, 0.9], "differs"),
        ([1.0, 1.0], [1.0, 1.0, 1.0], "explained by the seeds"),
        ([0.5, 0.7], [0.7, 0.5], "explained by the seeds"),
        ([0.5, 0.7], [np.nan, np.nan], "differs"),
        ([np.nan, np.nan], [np.nan, np.nan], "the same"),
        ([np.nan, np.nan], [np.nan, np.nan, np.nan], "the same"),
        ([0.5], [0.5], "the same"),
        ([0.5, 0.7], [0.5, 0.7 + 1e-9], "the same but for the last digits"),
        ([0.5], [0.5 + 1e-8], "the same but for the last digits"),
        ([0.5, 0.7], [0.5, 0.701], "explained by the seeds"),
        ([0.5], [0.6], "too few seeds to say"),
    ],
)
def test_one_cell(results: list[float], reference: list[float], expected: str) -> None:
    assert verdicts(cell(results), cell(reference)) == {expected: 1}


def test_cells_of_one_run_only_are_told_and_change_nothing() -> None:
    more = pd.concat([run(1), scores_of({("csl", "proposed", 20, 0, "EAR"): [1.0]}, experiment="real")])
    compared = compare(more, run(1))
    assert compared.explained
    assert "1 cells are only in the results:\n  real default published csl D 20: 1 of EAR\n" in compared.summary()
    assert "only in the reference" in compare(run(1), more).summary()


def test_verdicts_are_compared_where_both_runs_have_one(tmp_path: Path) -> None:
    told = {"one": ["holds", "not run", "holds"], "other": ["not decidable", "holds", "holds"]}
    for name, verdicts in told.items():
        (tmp_path / name).mkdir()
        write_csv(run(1), tmp_path / name / "scores.csv")
        write_csv(pd.DataFrame({"claim": [1, 2, 3], "verdict": verdicts, "note": ""}), tmp_path / name / "claims.csv")
    done = command(tmp_path / "one", tmp_path / "other")
    assert done.returncode == 1
    assert done.stdout.endswith(
        "2 claims are in both runs, 1 of them with the same verdict\n  claim 1: holds against not decidable\n"
    )
    assert command(tmp_path / "one", tmp_path / "one").returncode == 0


def command(*folders: Path) -> subprocess.CompletedProcess[str]:
    words = [sys.executable, "-m", "evaluation", "compare", *map(str, folders)]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)


def test_the_command(tmp_path: Path) -> None:
    runs = {"one": run(1), "other": run(2, shift=4.0), "apart": cell([0.5, 0.6])}
    for name, scores in runs.items():
        (tmp_path / name).mkdir()
        write_csv(scores, tmp_path / name / "scores.csv")
    assert command(tmp_path / "one", tmp_path / "one").returncode == 0
    differing = command(tmp_path / "one", tmp_path / "other")
    assert (differing.returncode, differing.stdout.count("ARI_o")) == (1, 1)
    missing = command(tmp_path / "one", tmp_path / "nowhere")
    assert missing.returncode == 2
    assert missing.stderr == f"no file {tmp_path / 'nowhere' / 'scores.csv'}: `make study` writes it\n"
    apart = command(tmp_path / "one", tmp_path / "apart")
    assert apart.returncode == 2
    assert "no cell in common" in apart.stderr
    (tmp_path / "apart" / "scores.csv").write_text("a,b\n1,2\n")
    assert command(tmp_path / "one", tmp_path / "apart").returncode == 2


def test_the_name_of_an_experiment_is_told_as_it_is() -> None:
    key = ("csl", "proposed", 20, 0, "EAR")
    two = (scores_of({key: values}, experiment="banana") for values in ([1.0, 1.0], [np.nan, np.nan]))
    [line] = [line for line in compare(*two).summary().splitlines() if "EAR" in line]
    assert "banana" in line
    assert "–" in line
