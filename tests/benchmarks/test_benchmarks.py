"""Benchmarks: what they measure is what they say, and they run to their end."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmarks.cases import SAMPLERS, Case, all_cases, make_trials
from benchmarks.convergence import RUNNERS, reached
from benchmarks.measure import measure
from benchmarks.summary import exponent
from model import METHODS
from tests.synthetic import OBJECTS_COLUMNS, TRIALS_COLUMNS, own_rows, write_rows

ROOT = Path(__file__).parents[2]


def run(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", *arguments], cwd=ROOT, check=True, capture_output=True)


def test_trials_are_as_large_as_the_case_says() -> None:
    case = Case("", 0, trials=50, dimensions=(3, 5, 2, 7, 4), vocabulary=30, words=5)
    trials = make_trials(case)
    assert trials.count == 50
    assert tuple(channel.dim for channel in trials.channels) == case.dimensions
    assert len(trials.vocabulary) == 30
    assert set(trials.sentence_lengths) == {5}
    assert len(trials.channels[1].features) == pytest.approx(100, abs=20)


def test_every_method_and_sampler_is_measured_at_the_papers_sizes() -> None:
    paper = {(case.method, case.sampler) for case in all_cases(False) if case.series == "paper"}
    models = {method for method in METHODS if method != "mmlda_released"}
    assert paper == {(method, sampler) for method in models for sampler in ("collapsed", "mixing")} | {
        (method, sampler) for method in METHODS for sampler in ("published", "released")
    }
    sizes = {series: [c.size for c in all_cases(False) if c.series == series] for series in ("D", "K", "dimension")}
    assert [(min(size), max(size)) for size in sizes.values()] == [(40, 40_000), (10, 100), (10, 500)]


def test_the_time_to_the_goal_is_that_from_which_all_lengths_reach_it() -> None:
    columns = ["D", "sampler", "seconds", "log_joint", "lowest", "r_hat", "r_hat_used"]
    rows = [
        [20, "a", 0.1, 5.0, 1.0, 1.01, 1.0],
        [20, "a", 0.2, 9.0, 8.0, 1.30, 1.0],
        [20, "a", 0.4, 8.0, 7.0, 1.04, 1.0],
        [20, "b", 0.1, 5.0, 1.0, 2.00, np.inf],
    ]
    assert list(reached(pd.DataFrame(rows, columns=columns))) == [
        ["20", "a", "0.40", "0.10", "9", "8", "0.20"],
        ["20", "b", "(2.00 at 0.1)", "(inf at 0.1)", "5", "1", "0.10"],
    ]


def test_exponent_of_growth() -> None:
    assert exponent([1, 10, 20], [7.0, 3.0, 12.0]) == pytest.approx(2.0)


@pytest.mark.slow
def test_memory_is_that_of_the_fit_alone() -> None:
    """Not of the process that starts it, and more for more trials."""
    mine = np.ones((600, 1024, 1024 // 8))
    small, large = (measure(Case("", 0, trials=D, iterations=1)) for D in (40, 20_000))
    assert small.peak_mebibytes < mine.nbytes / 2**20
    assert small.peak_mebibytes < small.baseline_mebibytes + 10 < large.peak_mebibytes


@pytest.mark.slow
def test_all_benchmarks_run(tmp_path: Path) -> None:
    run("benchmarks", "--quick", "--out", str(tmp_path))
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == ["fits.csv", "kernels.csv", "roofline.png", "scaling.png", "summary.md"]
    assert len(pd.read_csv(tmp_path / "fits.csv")) == len(list(all_cases(True)))
    kernels = pd.read_csv(tmp_path / "kernels.csv")
    assert kernels.share_of_peak.between(0, 1).all()


@pytest.mark.slow
def test_samplers_are_compared_on_feature_files(tmp_path: Path) -> None:
    trials, objects = own_rows(trials=12, object_dimension=6)
    write_rows(trials, TRIALS_COLUMNS, tmp_path / "trials.parquet")
    write_rows(objects, OBJECTS_COLUMNS, tmp_path / "objects.parquet")
    files = [str(tmp_path / name) for name in ("trials.parquet", "objects.parquet")]
    run("benchmarks.samplers", *files, "--out", str(tmp_path), "--seeds", "2")
    rows = pd.read_csv(tmp_path / "comparison.csv")
    fits = 2 * len(SAMPLERS) * 2  # rates of omission, samplers, seeds
    assert len(rows) == 3 * fits
    assert rows.groupby("method").EAR.count().to_dict() == {"mmlda": 0, "no_mec2": fits, "proposed": fits}
    assert rows.ARI_p.between(-1, 1).all()
    assert rows[rows.ROW == 40].r_hat.isna().all()
    assert (tmp_path / "comparison.md").read_text().count("\n") == 2 + 3 * 2 * len(SAMPLERS)
    run("benchmarks.convergence", *files, "--out", str(tmp_path), "--chains", "2", "--quick")
    times = pd.read_csv(tmp_path / "convergence_time.csv")
    assert times.sampler.value_counts().to_dict() == dict.fromkeys(RUNNERS, 2)
    assert (times.lowest <= times.log_joint).all()
    assert (tmp_path / "convergence_time.png").stat().st_size > 10_000
    assert all(f"| 12 | {sampler} |" in (tmp_path / "convergence_time.md").read_text() for sampler in RUNNERS)
