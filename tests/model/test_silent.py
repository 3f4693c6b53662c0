"""States of which the spoken part is given: it stays, and the rest follows its distribution given that part."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.special import softmax

from model import METHODS, Prior, Problem
from model.data import Floats, Ints
from model.joint import log_marginal_joint
from model.silent import complete
from model.state import Partition
from tests.model.stat_asserts import assert_means
from tests.synthetic import trials_of_model

PRIOR = Prior(categories=3, mean_precision=0.5, scale=0.5, extra_degrees_of_freedom=3.0)
LEARNED = PRIOR.model_copy(update={"mean_precision": "learned", "mean_precision_range": (0.001, 10.0)})


def problem_of(objects: list[int], method: str = "proposed", *priors: Prior) -> Problem:
    """Two trials of at most three words, three channels."""
    trials = trials_of_model(np.random.default_rng(5), objects, [3, 2])
    return Problem.of(trials, method, priors or PRIOR)


def given(problem: Problem) -> tuple[tuple[Ints, ...], Ints]:
    """Categories of what is spoken of, and an allowed F."""
    F = np.array([0, 1, 2, 1, 0]) if problem.method.has_frames else np.empty(0, dtype=np.int64)
    return (np.array([0, 2]), np.array([1, 1]), np.array([2, 0])), F


@pytest.mark.parametrize("method", METHODS)
def test_where_all_is_spoken_of_the_log_joint_is_that_of_the_state(method: str) -> None:
    problem = problem_of([1, 1], method)
    spoken, F = given(problem)
    found = complete(np.random.default_rng(0), problem, spoken, F, sweeps=4)
    assert np.allclose(found.trace_log_joint, log_marginal_joint(problem, Partition(spoken, F)), rtol=0, atol=1e-9)


def test_speakers_with_the_same_features_keep_their_own_categories() -> None:
    problem = problem_of([2, 2])
    channels = (replace(own, features=np.zeros_like(own.features)) for own in problem.trials.channels)
    problem = replace(problem, trials=replace(problem.trials, channels=tuple(channels)))
    spoken, F = given(problem)
    z = complete(np.random.default_rng(0), problem, spoken, F, sweeps=1).state.z
    for own, channel, expected in zip(z, problem.trials.channels, spoken, strict=True):
        assert np.array_equal(own[channel.speaker], expected)


@pytest.mark.parametrize("method", METHODS)
def test_silent_elements_alone_move(method: str) -> None:
    problem = problem_of([3, 2], method)
    spoken, F = given(problem)
    lasts = [complete(np.random.default_rng(seed), problem, spoken, F, sweeps=1) for seed in range(40)]
    for c, channel in enumerate(problem.trials.channels):
        z = np.stack([last.state.z[c] for last in lasts])
        silent = np.setdiff1d(np.arange(z.shape[1]), channel.speaker)
        assert np.array_equal(z[:, channel.speaker], np.tile(spoken[c], (40, 1)))
        assert (np.ptp(z[:, silent], axis=0) > 0).all()
    for last in lasts:
        assert np.array_equal(last.state.F, F)
        assert last.trace_log_joint[-1] == pytest.approx(log_marginal_joint(problem, last.state), abs=1e-9)


def exact_mean(problem: Problem, spoken: tuple[Ints, ...], F: Ints) -> float:
    """E log p(X, w, z, F, κ0) over the silent elements and κ0 given the rest, all of them listed."""
    z = [np.zeros(len(channel.features), dtype=np.int64) for channel in problem.trials.channels]
    places = []
    for c, channel in enumerate(problem.trials.channels):
        z[c][channel.speaker] = spoken[c]
        places += [(c, i) for i in np.setdiff1d(np.arange(len(z[c])), channel.speaker)]
    logs = []
    for values in product(*(prior.mean_precisions for prior in problem.priors)):
        problem = problem.given(values)
        for chosen in product(range(PRIOR.categories), repeat=len(places)):
            for (c, i), k in zip(places, chosen, strict=True):
                z[c][i] = k
            logs.append(log_marginal_joint(problem, Partition(tuple(z), F)))
    listed: Floats = np.array(logs)
    return float(softmax(listed) @ listed)


@pytest.mark.parametrize("position", [PRIOR, LEARNED])
def test_the_mean_is_that_of_the_distribution_given_what_is_spoken_of(position: Prior) -> None:
    problem = problem_of([2, 2], "proposed", PRIOR, position, PRIOR)
    spoken, F = given(problem)
    chains = [complete(np.random.default_rng(seed), problem, spoken, F, 4000) for seed in range(2)]
    draws = np.stack([chain.trace_log_joint for chain in chains])[:, :, None]
    assert_means(draws, np.array([exact_mean(problem, spoken, F)]))


def test_what_was_learned_of_kappa_makes_no_difference() -> None:
    problem = problem_of([2, 2], "proposed", PRIOR, LEARNED, PRIOR)
    traces = [
        complete(np.random.default_rng(0), one, *given(problem), sweeps=5).trace_log_joint
        for one in (problem, problem.given((1.0, 2.0, 1.0)), replace(problem, learned=(0.2, 0.2, 0.2)))
    ]
    assert np.array_equal(traces[0], traces[1])
    assert np.array_equal(traces[0], traces[2])
