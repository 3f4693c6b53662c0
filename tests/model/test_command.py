"""A fit without a study: `python -m model fit`, and what Python shows of a fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from features.table import read_table
from model import Blocked, Prior, Problem, Trials, fit, load
from model.__main__ import main
from tests.synthetic import write_own_study

SHORT = ("--sampler", "blocked", "--set", "iterations=5", "--set", "keep_history=0")


@pytest.fixture
def tables(tmp_path: Path) -> list[str]:
    write_own_study(tmp_path)
    return [str(tmp_path / "trials.parquet"), str(tmp_path / "objects.parquet")]


def test_it_is_the_fit_of_the_same_settings(
    tables: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    changes = ("--method", "no_mec2", "--prior", "categories=4", "--prior", "color.scale=0.02", "--seed", "3")
    assert main(["fit", *tables, "--to", str(tmp_path / "new" / "fit.npz"), *SHORT, *changes]) == 0
    table = read_table(tables[0], tables[1], need_attention=True)
    trials = Trials.from_arrays(**table.learning_input())
    priors = [Prior(categories=4)] * 3 + [Prior(categories=4, scale=0.02)]
    sampler = Blocked(iterations=5, keep_history=0)
    expected = fit(Problem.of(trials, "no_mec2", priors), sampler, np.random.default_rng(3))
    found = load(tmp_path / "new" / "fit.npz")
    assert found.problem.priors == tuple(priors)
    assert found.sampler == sampler
    assert np.array_equal(found.trace_log_joint, expected.trace_log_joint)
    said = capsys.readouterr()
    assert said.out == f"{tmp_path / 'new' / 'fit.npz'}: {found!r}\n"
    assert said.err.splitlines()[-1] == "5 of 5 sweeps"


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (("--set", "iterations=0"), "--set iterations: Input should be greater than or equal to 1"),
        (("--set", "sweeps=5"), "--set sweeps: unknown (allowed: iterations, chains,"),
        (("--set", "iterations"), "--set iterations: must be NAME=VALUE"),
        (("--prior", "scale=1", "--prior", "scale=2"), "--prior scale: stands twice"),
        (("--prior", "colour.scale=1"), "--prior colour.scale: there is no such channel (there are action, "),
        (("--prior", "color.scal=1"), "--prior color.scal: unknown (allowed: categories,"),
        (("--prior", "scale=-1", "--prior", "categories=0"), "--prior scale: Input should be greater than 0"),
        (("--set", "parameters=mean", "--set", "keep_history=0"), "--set: parameters: mean needs kept states"),
        (("--seed", "-1"), "--seed -1: must be 0 or more"),
    ],
)
def test_what_is_of_no_use_is_named_and_nothing_is_written(
    wrong: tuple[str, ...], says: str, tables: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["fit", *tables, "--to", str(tmp_path / "fit.npz"), *wrong]) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "fit.npz").exists()


def test_tables_that_are_none(tables: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["fit", tables[0], str(tmp_path / "none"), "--to", str(tmp_path / "fit.npz")]) == 2
    assert f"{tmp_path / 'none'}: no such file" in capsys.readouterr().err


def test_a_fit_is_shown_on_one_line(trials: Trials) -> None:
    shown = repr(fit(Problem.of(trials, "no_mec2"), Blocked(iterations=3), np.random.default_rng(0)))
    assert shown.startswith("<Fit of no_mec2 by blocked: 4 trials, 6 words, 3 iterations, log joint ")
    assert len(shown) < 200
    assert "\n" not in shown
