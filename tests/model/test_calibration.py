"""Simulation-based calibration (Talts et al. 2018): ranks of the truth among posterior draws are uniform."""

from __future__ import annotations

import numpy as np
import pytest

from model import Prior, Problem
from model.joint import draw_data, draw_parameters
from tests.model.samplers import BROKEN, EXACT, moved_by, quantities, tiny_trials
from tests.model.stat_asserts import uniform_p_value

DESIGN = tiny_trials([1, 2, 1], [2, 2, 1], W=3)
PRIORS = (
    Prior(categories=2, mean_precision=0.3, scale=0.5, extra_degrees_of_freedom=3.0, word_concentration=0.3),
    Prior(
        categories=2,
        mean_precision=0.5,
        scale=0.3,
        extra_degrees_of_freedom=4.0,
        word_concentration=0.3,
        concentration=2.0,
    ),
)
DRAWS, THIN, BURN_IN = 31, 5, 60
# The smallest p-value over about thirty quantities that a right sampler may show.
SMALLEST = 1e-5


def ranks(method: str, kind: str, replications: int) -> np.ndarray:
    """(replications, Q) ranks 0..DRAWS of the true state's quantities among draws; ties are broken at random."""
    sampler, design, result = EXACT[kind], Problem.of(DESIGN, method, PRIORS), []
    for seed in range(replications):
        rng = np.random.default_rng([seed, 77])
        truth = draw_parameters(rng, design)
        problem = draw_data(rng, design, truth)
        state = sampler.init(rng, problem)
        drawn = []
        for i in range(BURN_IN + DRAWS * THIN):
            state = sampler.step(rng, problem, state, i)
            if i >= BURN_IN and (i - BURN_IN) % THIN == 0:
                drawn.append(quantities(problem, state))
        true = quantities(problem, moved_by(sampler, truth))
        below, equal = np.sum(drawn < true - 1e-9, axis=0), np.sum(np.abs(drawn - true) <= 1e-9, axis=0)
        result.append(below + rng.integers(equal + 1))
    return np.array(result)


def worst_p_value(found: np.ndarray) -> float:
    return min(uniform_p_value(found[:, q], DRAWS) for q in range(found.shape[1]))


@pytest.mark.slow
@pytest.mark.parametrize("sampler", sorted(EXACT))
def test_ranks_are_uniform(method: str, sampler: str) -> None:
    assert worst_p_value(ranks(method, sampler, 160)) > SMALLEST


@pytest.mark.slow
@pytest.mark.parametrize(("sampler", "broken"), [("blocked", "F is deaf"), ("collapsed", "z with another V0")])
def test_a_broken_kernel_is_not_calibrated(sampler: str, broken: str, monkeypatch: pytest.MonkeyPatch) -> None:
    module, name, breaker = BROKEN[sampler][broken]
    monkeypatch.setattr(module, name, breaker(getattr(module, name)))
    assert worst_p_value(ranks("no_mec2", sampler, 320)) < SMALLEST
