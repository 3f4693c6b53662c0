"""The joint distribution test (Geweke 2004), and kernel steps that leave exact draws of the joint as they are."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from scipy import stats

from model import Prior, Problem
from model.data import Floats
from model.joint import draw_data, draw_mean_precision, draw_parameters
from tests.model.samplers import (
    BROKEN,
    EXACT,
    HEARING,
    Priors,
    can_break,
    moved_by,
    quantities,
    redraw,
    tiny_trials,
)
from tests.model.stat_asserts import LIMIT, assert_means, assert_same_distribution, distances

# The chain of states and data does not move with κ0 = 0.001: the data keep the means, and these keep the data.
MOVING = (
    Prior(categories=3, mean_precision=0.8, scale=0.5, extra_degrees_of_freedom=3.0, word_concentration=0.3),
    Prior(
        categories=2,
        mean_precision=1.0,
        scale=0.3,
        extra_degrees_of_freedom=4.0,
        word_concentration=0.4,
        concentration=2.0,
    ),
)
PAPER = (Prior(),) * 2
DESIGN = tiny_trials([1, 2, 1], [2, 2, 1], W=3)


@lru_cache
def independent(method: str, priors: Priors, kind: str, count: int) -> Floats:
    """(count, Q) of data and states drawn from the joint distribution."""
    rng, design, sampler = np.random.default_rng(1), Problem.of(DESIGN, method, priors), EXACT[kind]
    values = []
    for _ in range(count):
        given = draw_mean_precision(rng, design)
        state = draw_parameters(rng, given)
        values.append(quantities(draw_data(rng, given, state), moved_by(sampler, state)))
    return np.array(values)


def alternating(method: str, priors: Priors, kind: str, steps: int) -> Floats:
    """(1, steps, Q) along a chain of kernel steps: before each κ0 is drawn where it is learned, after it new data."""
    rng, design, sampler = np.random.default_rng(2), Problem.of(DESIGN, method, priors), EXACT[kind]
    given = draw_mean_precision(rng, design)
    whole = draw_parameters(rng, given)
    problem, state = draw_data(rng, given, whole), moved_by(sampler, whole)
    values = []
    for i in range(steps):
        problem = sampler.learn(rng, problem, state, i)
        state = sampler.step(rng, problem, state, i)
        # Before the data are drawn anew: a block that ignores the data goes unnoticed if they follow it.
        values.append(quantities(problem, state))
        problem = redraw(rng, problem, state)
    return np.array(values)[None]


@pytest.mark.parametrize("sampler", sorted(EXACT))
def test_kernel_and_joint_agree(method: str, sampler: str) -> None:
    assert_same_distribution(alternating(method, MOVING, sampler, 2000), independent(method, MOVING, sampler, 2000))


@pytest.mark.slow
@pytest.mark.parametrize("sampler", sorted(EXACT))
def test_kernel_and_joint_agree_closely(method: str, sampler: str) -> None:
    assert_same_distribution(
        alternating(method, MOVING, sampler, 10_000), independent(method, MOVING, sampler, 10_000)
    )


def before_and_after(method: str, priors: Priors, kind: str, count: int, steps: int) -> tuple[Floats, Floats]:
    """Two times (count, Q): of independent draws from the joint, and after kernel steps with the same data."""
    rng, design, sampler = np.random.default_rng(3), Problem.of(DESIGN, method, priors), EXACT[kind]
    before, after = [], []
    for _ in range(count):
        whole = draw_parameters(rng, design)
        problem, state = draw_data(rng, design, whole), moved_by(sampler, whole)
        before.append(quantities(problem, state))
        for i in range(steps):
            state = sampler.step(rng, problem, state, i)
        after.append(quantities(problem, state))
    return np.array(before), np.array(after)


def change(method: str, priors: Priors, kind: str, count: int, steps: int) -> Floats:
    """(1, count, Q) what kernel steps change in exact draws: zero on average."""
    before, after = before_and_after(method, priors, kind, count, steps)
    return np.asarray((after - before)[None])


@pytest.mark.parametrize("priors", [MOVING, PAPER], ids=["moving", "paper"])
@pytest.mark.parametrize("sampler", sorted(EXACT))
def test_exact_draws_stay_exact(method: str, sampler: str, priors: Priors) -> None:
    changed = change(method, priors, sampler, 500, steps=3)
    assert_means(changed, np.zeros(changed.shape[2]))


@pytest.mark.slow
@pytest.mark.parametrize("priors", [MOVING, PAPER], ids=["moving", "paper"])
@pytest.mark.parametrize("sampler", sorted(EXACT))
def test_exact_draws_keep_their_distribution(method: str, sampler: str, priors: Priors) -> None:
    """More draws than above, and whole distributions: against other draws, by Kolmogorov and Smirnov."""
    before, after = before_and_after(method, priors, sampler, 4000, steps=4)
    assert_means((after - before)[None], np.zeros(before.shape[1]))
    fresh = independent(method, priors, sampler, 4000)
    assert min(stats.ks_2samp(after[:, q], fresh[:, q]).pvalue for q in range(after.shape[1])) > 1e-5


CONTROLS = [
    (method, sampler, name)
    for method in HEARING
    for sampler, kernels in BROKEN.items()
    for name in kernels
    if can_break(method, name)
]
FAST = "no_mec2"
# What only methods with words of no channel or word order have, and one of them that has it.
OPEN = {"θ of ∅ never learns": "proposed_open_ordered", "order is forgotten": "proposed_ordered"}


def break_kernel(monkeypatch: pytest.MonkeyPatch, sampler: str, broken: str) -> None:
    module, name, breaker = BROKEN[sampler][broken]
    monkeypatch.setattr(module, name, breaker(getattr(module, name)))


# One method, which has all kernels: exact draws, below, are spoiled in every method.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "sampler", "broken"), [one for one in CONTROLS if one[0] == OPEN.get(one[2], "proposed")]
)
def test_a_broken_kernel_does_not_pass_the_joint_distribution_test(
    method: str, sampler: str, broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    expected = independent(method, MOVING, sampler, 5000)
    break_kernel(monkeypatch, sampler, broken)
    error = expected.std(axis=0) / np.sqrt(len(expected))
    off = distances(alternating(method, MOVING, sampler, 5000), expected.mean(axis=0), error)
    assert off.max() > LIMIT


@pytest.mark.parametrize(
    ("method", "sampler", "broken", "priors"),
    [
        pytest.param(*control, priors, id=f"{name}-{'-'.join(control)}", marks=() if fast else pytest.mark.slow)
        for name, priors in (("moving", MOVING), ("paper", PAPER))
        for control in CONTROLS
        for fast in [priors is MOVING and control[0] == OPEN.get(control[2], FAST)]
    ],
)
def test_a_broken_kernel_spoils_exact_draws(
    method: str, sampler: str, broken: str, priors: Priors, monkeypatch: pytest.MonkeyPatch
) -> None:
    break_kernel(monkeypatch, sampler, broken)
    changed = change(method, priors, sampler, 1000, steps=3)
    assert distances(changed, np.zeros(changed.shape[2])).max() > LIMIT
