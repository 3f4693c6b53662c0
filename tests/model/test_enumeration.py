"""The blocked sampler against the exact posterior of a model small enough to enumerate."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest

from model import Prior, Settings, Trials, blocked
from model import conditionals as given
from model.data import Floats, Ints
from model.frames import distinct_frames
from model.joint import draw_frames_prior, log_marginal_joint
from tests.synthetic import trials_of_model

PRIORS = (Prior(categories=2, mean_strength=0.5, scale=0.5, extra_freedom=3.0, word_concentration=0.3),) * 2


@pytest.fixture
def tiny() -> Trials:
    """Three trials, four objects, sentences of two words and of one; channels action and position."""
    trials = trials_of_model(np.random.default_rng(8), [2, 1, 1], [2, 1, 1], W=2)
    words = np.tile([0, 1, 0, 0], (2, 1))
    # Features that hardly tell the elements apart, so that the words do.
    channels = tuple(replace(channel, features=0.3 * channel.features) for channel in trials.channels[:2])
    return replace(trials, channels=channels, words=words, vocabulary=("word0", "word1"))


def frames(rule: str) -> list[tuple[int, ...]]:
    if rule == "every":
        return [()]
    pairs = distinct_frames(2, 2).tolist() if rule == "distinct" else list(product(range(2), repeat=2))
    return [(*pair, *singles) for pair in pairs for singles in product(range(2), repeat=2)]


def label_free(trials: Trials, rule: str, z: tuple[Ints, ...], F: Ints) -> Floats:
    """For each channel which elements share a category; the channel of each word; the log joint, in tens of nats."""
    pairs = [float(part[i] == part[j]) for part in z for i in range(len(part)) for j in range(i)]
    return np.array([*pairs, *F.astype(float), log_marginal_joint(trials, rule, PRIORS, z, F) / 10.0])


def exact(trials: Trials, rule: str) -> Floats:
    sizes = [len(channel.features) for channel in trials.channels]
    log_p, values = [], []
    for labels in product(range(2), repeat=sum(sizes)):
        z = (np.array(labels[: sizes[0]]), np.array(labels[sizes[0] :]))
        for frame in frames(rule):
            F = np.array(frame, dtype=np.int64)
            log_p.append(log_marginal_joint(trials, rule, PRIORS, z, F))
            values.append(label_free(trials, rule, z, F))
    p = np.exp(np.array(log_p) - max(log_p))
    return np.asarray((p / p.sum()) @ np.array(values))


def sampled(trials: Trials, rule: str, steps: int = 4000) -> tuple[Floats, Floats]:
    """Means over a chain and their Monte Carlo errors, by batch means."""
    rng = np.random.default_rng(21)
    state = blocked.init(rng, trials, rule, PRIORS, Settings())
    values = []
    for _ in range(steps):
        state = blocked.step(rng, state, trials, rule, PRIORS, Settings())
        values.append(label_free(trials, rule, state.z, state.F))
    batches = np.array(values)[steps % 40 :].reshape(40, steps // 40, -1).mean(axis=1)
    return batches.mean(axis=0), batches.std(axis=0, ddof=1) / np.sqrt(40)


def worst_error(trials: Trials, rule: str) -> float:
    """The largest distance from the exact posterior, in standard errors (at least 0.002 each)."""
    mean, error = sampled(trials, rule)
    return float(np.max(np.abs(mean - exact(trials, rule)) / np.maximum(error, 0.002)))


def test_posterior_is_the_exact_one(tiny: Trials, rule: str) -> None:
    assert worst_error(tiny, rule) < 4.5


def without_counts(trials: Trials, index: int, prior: Prior, z: Ints, explained: Any) -> Floats:
    """Word distributions that never learn."""
    return np.full((prior.categories, len(trials.vocabulary)), prior.word_concentration)


def at_random(rng: np.random.Generator, trials: Trials, rule: Any, log_weights: Floats) -> Ints:
    """Frames that do not listen."""
    return draw_frames_prior(rng, trials, rule)


BROKEN = {"every": ("word_concentration", without_counts)} | dict.fromkeys(
    ("distinct", "independent"), ("draw_frames", at_random)
)


def test_a_broken_kernel_is_noticed(tiny: Trials, rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(given, *BROKEN[rule])
    assert worst_error(tiny, rule) > 6
