"""Priors of frames: what they allow, how probable it is, and what they draw."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from itertools import permutations, product

import numpy as np
import pytest

from model import METHODS, Prior, Problem, Trials
from model.data import Ints
from model.frames import Every
from model.joint import draw_parameters, log_joint
from model.kernels.conditionals import assignment_log_weights
from tests.model.samplers import NO_MODELS
from tests.synthetic import trials_of_model

FRAMES: dict[str, Callable[[int, int], list[tuple[int, ...]]]] = {
    "proposed": lambda C, N: list(permutations(range(C), N)),
    "no_mec2": lambda C, N: list(product(range(C), repeat=N)),
}


@pytest.mark.parametrize("name", FRAMES)
def test_allowed_frames(name: str) -> None:
    prior = METHODS[name].frame_prior
    for C, N in product(range(1, 5), range(4)):
        if N <= prior.word_limit(C):
            assert prior.allowed(C, N).tolist() == [list(frame) for frame in FRAMES[name](C, N)]
            assert prior.count(C, N) == len(FRAMES[name](C, N))


@pytest.mark.parametrize("name", FRAMES)
def test_draws_have_the_probability_that_is_stated(name: str) -> None:
    trials, prior = trials_of_model(np.random.default_rng(0), [1, 1, 1], [2, 0, 1]), METHODS[name].frame_prior
    rng = np.random.default_rng(1)
    drawn = Counter(tuple(prior.draw(rng, trials)) for _ in range(4000))
    assert len(drawn) == len(FRAMES[name](3, 2)) * 3
    for F, times in drawn.items():
        probability = np.exp(prior.log_probability(trials, np.array(F)))
        assert abs(times - 4000 * probability) < 5 * np.sqrt(4000 * probability)


def test_methods_without_truth_tests_are_no_models_and_all_of_them() -> None:
    """A method that is left out of the tests of its posterior is left out by name, with a reason."""
    assert set(NO_MODELS) == {name for name, method in METHODS.items() if not method.is_model}


def test_released_frames_are_no_conditional_of_a_joint(trials: Trials, priors: tuple[Prior, ...]) -> None:
    """Why: given the same z, θ and F, z is not drawn as the joint says, in which every word counts for every z."""
    problem = Problem.of(trials, "mmlda_released", priors)
    state = draw_parameters(np.random.default_rng(0), problem)
    c, i = 0, int(trials.word_speaker[0][np.flatnonzero(state.F != 0)[0]])
    drawn = assignment_log_weights(problem, c, state)[i]
    categories = priors[c].categories
    moved = [replace(state, z=(_with(state.z[c], i, k), *state.z[1:])) for k in range(categories)]
    joint = np.array([log_joint(problem, one) for one in moved])
    assert not np.allclose(drawn - drawn[0], joint - joint[0])
    as_model = Problem.of(trials, "mmlda", priors)
    assert np.allclose(joint, [log_joint(as_model, replace(one, F=one.F[:0])) for one in moved])


def _with(z: Ints, i: int, k: int) -> Ints:
    return np.concatenate([z[:i], [k], z[i + 1 :]])


@pytest.mark.parametrize("name", METHODS)
def test_every_word_is_explained_once_or_by_every_channel(name: str, trials: Trials) -> None:
    prior = METHODS[name].frame_prior
    F = prior.draw(np.random.default_rng(0), trials)
    by_channel = [prior.explained(trials, F, c) for c in range(prior.sources(3))]
    assert np.all(np.sum(by_channel, axis=0) == (3 if type(prior) is Every else 1))
