"""Comparisons whose verdict is known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import pytest

from evaluation.claims.judging import Cell, Comparison, Sum, combine, judge
from evaluation.scores import UNITS

SPREAD = [-0.02, -0.01, 0.0, 0.01, 0.02, -0.015, 0.015, 0.005, -0.005, 0.0]


def cell(measure: str, D: int = 20) -> Sum:
    return Sum(((1.0, Cell("simulator", D, 0, "proposed", measure)),))


A, B, LATER = cell("A"), cell("B"), cell("B", 40)
ONE = Sum(constant=1.0)


def by_seed(*sets: Sequence[float]) -> pd.Series[float]:
    """Values of the seeds of some data sets."""
    places = [(dataset, seed) for dataset, own in enumerate(sets, 1) for seed in range(1, len(own) + 1)]
    values = [value for own in sets for value in own]
    return pd.Series(values, pd.MultiIndex.from_tuples(places, names=UNITS), dtype=float)


def verdict(comparison: Comparison, values: Mapping[Sum, Sequence[float]], seed: int = 0) -> str:
    series = {total.terms[0][1]: by_seed(x) for total, x in values.items()}
    empty = pd.Series(dtype=float)
    return judge(comparison, lambda one: series.get(one, empty), np.random.default_rng(seed)).verdict


def around(mean: float) -> list[float]:
    return [mean + d for d in SPREAD]


@pytest.mark.parametrize(
    ("relation", "difference", "bound", "expected"),
    [
        (">", 0.1, 0.0, "holds"),
        (">", -0.1, 0.0, "does not hold"),
        (">", 0.002, 0.0, "not decidable"),
        ("≥", 0.1, 0.0, "holds"),
        ("≤", 0.02, 0.05, "holds"),
        ("≤", 0.049, 0.05, "not decidable"),
        ("≤", 0.08, 0.05, "does not hold"),
        ("within ±", 0.0, 0.1, "holds"),
        ("within ±", -0.099, 0.1, "not decidable"),
        ("within ±", -0.2, 0.1, "does not hold"),
        ("within ±", 0.2, 0.1, "does not hold"),
    ],
)
def test_the_interval_and_the_bound_decide(relation: str, difference: float, bound: float, expected: str) -> None:
    comparison = Comparison(A, relation, B, bound)
    assert verdict(comparison, {A: around(0.5 + difference), B: [0.5] * 10}) == expected


@pytest.mark.parametrize(
    ("values", "expected"),
    [([1.0] * 10, "holds"), ([1.0] * 9 + [0.9], "not decidable"), ([0.9, 0.8] * 5, "does not hold")],
)
def test_exactly_one(values: list[float], expected: str) -> None:
    assert verdict(Comparison(A, "=", ONE), {A: values}) == expected


def test_without_spread_the_point_decides() -> None:
    same = {A: around(0.5), B: around(0.5)}
    assert verdict(Comparison(A, "≥", B), same) == "holds"
    assert verdict(Comparison(A, ">", B), same) == "does not hold"


def test_seeds_are_paired_within_one_number_of_trials_only() -> None:
    """A wide spread that both sides share: its difference is sharp in pairs, and drowns without them."""
    wide = [10 * d for d in SPREAD]
    higher = [x + 0.03 + d / 10 for x, d in zip(wide, SPREAD[::-1], strict=True)]
    assert verdict(Comparison(A, ">", B), {A: higher, B: wide}) == "holds"
    assert verdict(Comparison(A, ">", LATER), {A: higher, LATER: wide}) == "not decidable"


def test_the_interval_is_the_bootstrap_of_the_mean() -> None:
    """Of ten normal seeds it is near ± 1.96 standard errors, from below because the bootstrap divides by n."""
    values = by_seed(np.random.default_rng(1).normal(0.0, 1.0, 200).tolist())
    judged = judge(Comparison(A, ">", Sum()), lambda _: values, np.random.default_rng(0))
    error = values.std() / np.sqrt(len(values))
    assert (judged.low, judged.high) == pytest.approx(
        (values.mean() - 1.96 * error, values.mean() + 1.96 * error), abs=0.1 * error
    )
    assert judged == judge(Comparison(A, ">", Sum()), lambda _: values, np.random.default_rng(0))


def test_one_seed_leaves_everything_open() -> None:
    assert verdict(Comparison(A, ">", B), {A: [0.9], B: [0.1]}) == "not decidable"


def test_what_was_not_run() -> None:
    assert verdict(Comparison(A, ">", B), {A: around(0.5)}) == "not run"
    assert verdict(Comparison(A, ">", LATER), {A: around(0.5)}) == "not run"


def test_a_claim_needs_all_of_its_comparisons() -> None:
    assert combine(["holds", "holds"]) == "holds"
    assert combine(["holds", "not decidable"]) == "not decidable"
    assert combine(["not decidable", "not run"]) == "not run"
    assert combine(["not run", "does not hold", "holds"]) == "does not hold"


def test_comparisons_can_be_read() -> None:
    assert str(Comparison(A, ">", B)) == "A(A, D 20, ROW 0) > B(A, D 20, ROW 0)"
    assert str(Comparison(A, "≤", B, 0.05)) == "A(A, D 20, ROW 0) − B(A, D 20, ROW 0) ≤ 0.05"
    assert str(Comparison(A, "=", ONE)) == "A(A, D 20, ROW 0) = 1"
