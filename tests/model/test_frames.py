"""Priors of frames: what they allow, how probable it is, and what they draw."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from itertools import permutations, product

import numpy as np
import pytest

from model import METHODS, Trials
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


@pytest.mark.parametrize("name", METHODS)
def test_every_word_is_explained_once_or_by_every_channel(name: str, trials: Trials) -> None:
    prior = METHODS[name].frame_prior
    F = prior.draw(np.random.default_rng(0), trials)
    by_channel = [prior.explained(trials, F, c) for c in range(3)]
    assert np.all(np.sum(by_channel, axis=0) == (1 if prior.has_frames else 3))
