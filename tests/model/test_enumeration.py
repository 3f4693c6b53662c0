"""Both samplers against the exact posterior of models small enough to enumerate."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from model import METHODS, Prior, Problem
from model.data import Floats, Ints
from model.joint import log_marginal_joint
from model.state import Partition
from tests.model.samplers import BROKEN, EXACT, tiny_trials
from tests.model.stat_asserts import LIMIT, assert_means, distances

PRIORS = (
    Prior(categories=2, mean_precision=0.5, scale=0.5, extra_degrees_of_freedom=3.0, word_concentration=0.3),
) * 2


@pytest.fixture
def tiny(method: str) -> Problem:
    """Three trials, four objects, sentences of two words, one and one, of a vocabulary of two.

    Without frames each channel has a sentence of its own, as the model says.
    """
    trials = tiny_trials([2, 1, 1], [2, 1, 1], W=2)
    # Features that hardly tell the elements apart, so that the words do.
    channels = tuple(replace(channel, features=0.3 * channel.features) for channel in trials.channels)
    heard = [0, 1, 0, 0]
    words = np.array([heard, heard if METHODS[method].has_frames else [1, 1, 0, 1]])
    return Problem.of(replace(trials, channels=channels, words=words), method, PRIORS)


def frames(problem: Problem) -> list[tuple[int, ...]]:
    """Every F of the sentences of two words, one and one."""
    if not problem.frame_prior.has_frames:
        return [()]
    pairs, single = (problem.frame_prior.allowed(2, words).tolist() for words in (2, 1))
    return [(*pair, *one, *other) for pair in pairs for one in single for other in single]


def label_free(problem: Problem, z: tuple[Ints, ...], F: Ints) -> Floats:
    """Which elements of a channel share a category; the channel of each word; both; the log joint."""
    pairs = [float(part[i] == part[j]) for part in z for i in range(len(part)) for j in range(i)]
    return np.array([*pairs, *F, *(F * pairs[0]), log_marginal_joint(problem, Partition(z, F))], dtype=np.float64)


def key(z: tuple[Ints, ...], F: Ints) -> bytes:
    return bytes(np.concatenate([*z, F]).astype(np.uint8))


def every_state(problem: Problem) -> dict[bytes, Floats]:
    """The quantities of each of the 2 to the number of elements, times frames, states."""
    sizes = [len(channel.features) for channel in problem.trials.channels]
    values = {}
    for labels in product(range(2), repeat=sum(sizes)):
        z = (np.array(labels[: sizes[0]]), np.array(labels[sizes[0] :]))
        for frame in frames(problem):
            F = np.array(frame, dtype=np.int64)
            values[key(z, F)] = label_free(problem, z, F)
    return values


def exact_means(values: dict[bytes, Floats]) -> Floats:
    table = np.array(list(values.values()))
    p = np.exp(table[:, -1] - table[:, -1].max())
    return np.asarray((p / p.sum()) @ table)


def sampled(problem: Problem, sampler: str, values: dict[bytes, Floats], steps: int) -> Floats:
    """(1, steps, Q) along a chain."""
    rng, kernel = np.random.default_rng(21), EXACT[sampler]
    state = kernel.init(rng, problem)
    drawn = []
    for i in range(steps):
        state = kernel.step(rng, problem, state, i)
        drawn.append(values[key(state.z, state.F)])
    return np.array(drawn)[None]


@pytest.mark.parametrize("sampler", sorted(EXACT))
def test_posterior_is_the_exact_one(tiny: Problem, sampler: str) -> None:
    values = every_state(tiny)
    assert_means(sampled(tiny, sampler, values, 6000), exact_means(values))


# Others move a posterior of four objects too little to be seen here; the joint distribution test sees them.
@pytest.mark.parametrize(
    ("sampler", "broken"),
    [
        ("blocked", "π with another α"),
        ("blocked", "φ with another κ0"),
        ("blocked", "θ never learns"),
        ("collapsed", "z with another V0"),
        ("collapsed", "z too hot"),
    ],
)
def test_a_broken_kernel_is_noticed(
    tiny: Problem, sampler: str, broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    values = every_state(tiny)
    module, name, breaker = BROKEN[sampler][broken]
    monkeypatch.setattr(module, name, breaker(getattr(module, name)))
    # Where words may be of no channel they tell less of the categories.
    steps = 9000 if tiny.frame_prior.has_none else 3000
    assert distances(sampled(tiny, sampler, values, steps), exact_means(values)).max() > LIMIT
