"""Exact identities: each conditional is proportional to the joint. No sampling noise, no tolerance to tune."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from model import Prior, Settings, State, Trials, collapsed
from model.kernels import conditionals as given
from model.kernels.collapsed_assignments import Elements, channel_statistics, sweep
from model.data import Floats
from model.joint import draw_frames_prior, draw_parameters, log_joint, log_marginal_joint

Case = tuple[Trials, Any, tuple[Prior, ...], State, np.random.Generator]


@pytest.fixture
def case(trials: Trials, rule: str, priors: tuple[Prior, ...], rng: np.random.Generator) -> Case:
    if rule == "every":  # Each channel has a sentence of its own, as the model says.
        trials = replace(trials, words=rng.integers(len(trials.vocabulary), size=trials.words.shape))
    return trials, rule, priors, draw_parameters(rng, trials, rule, priors), rng


def with_channel(state: State, field: str, c: int, value: object) -> State:
    """The state with one channel's part of a field replaced."""
    parts = list(getattr(state, field))
    parts[c] = value
    return replace(state, **{field: tuple(parts)})


def assert_ratio(case: Case, change: State, log_conditional: Callable[[State], float]) -> None:
    """Log p(new) − log p(old) is the same by the conditional and by the joint."""
    trials, rule, priors, state, _ = case
    by_joint = log_joint(trials, rule, priors, change) - log_joint(trials, rule, priors, state)
    by_conditional = log_conditional(change) - log_conditional(state)
    assert by_conditional == pytest.approx(by_joint, rel=1e-9, abs=1e-8)
    assert abs(by_joint) > 1e-3  # the two states do differ


def assignment(case: Case, c: int) -> Floats:
    trials, rule, _, state, _ = case
    explained = given.explained_words(rule, state.F, c, len(trials.word_trial))
    return given.assignment_log_weights(
        trials, c, state.log_weights[c], state.mean[c], state.factor[c], state.log_words[c], explained
    )


@pytest.mark.parametrize("c", range(3))
def test_assignments(case: Case, c: int) -> None:
    _, _, priors, state, rng = case
    weights = assignment(case, c)
    z = rng.permutation(np.arange(len(state.z[c])) % priors[c].categories)
    rows = np.arange(len(z))
    assert_ratio(case, with_channel(state, "z", c, z), lambda s: float(np.sum(weights[rows, s.z[c]])))


@pytest.mark.parametrize("c", range(3))
def test_weights(case: Case, c: int) -> None:
    _, _, priors, state, rng = case
    drawn = given.draw_weights(rng, priors[c], state.z[c])
    change = with_channel(state, "log_weights", c, drawn)
    assert_ratio(case, change, lambda s: given.weights_log_density(priors[c], s.z[c], s.log_weights[c]))


@pytest.mark.parametrize("c", range(3))
def test_categories(case: Case, c: int) -> None:
    trials, _, priors, state, rng = case
    channel = trials.channels[c]
    mean, factor = given.draw_categories(rng, priors[c], channel, state.z[c], Settings())
    change = with_channel(with_channel(state, "mean", c, mean), "factor", c, factor)
    assert_ratio(
        case, change, lambda s: given.categories_log_density(priors[c], channel, s.z[c], s.mean[c], s.factor[c])
    )


def test_frames(case: Case) -> None:
    trials, rule, _, state, rng = case
    if rule == "every":
        assert state.F.size == 0
        return
    weights = given.word_log_weights(trials, state.z, state.log_words)
    F = state.F
    while np.array_equal(F, state.F):
        F = draw_frames_prior(rng, trials, rule)
    change = replace(state, F=F)
    assert_ratio(case, change, lambda s: given.frames_log_probability(trials, rule, weights, s.F))


@pytest.mark.parametrize("c", range(3))
def test_words(case: Case, c: int) -> None:
    trials, rule, priors, state, rng = case
    explained = given.explained_words(rule, state.F, c, len(trials.word_trial))
    concentration = given.word_concentration(trials, c, priors[c], state.z[c], explained)
    change = with_channel(state, "log_words", c, given.draw_words(rng, concentration))
    assert_ratio(case, change, lambda s: given.words_log_density(concentration, s.log_words[c]))


@pytest.mark.parametrize("c", range(3))
def test_collapsed_assignments(case: Case, c: int) -> None:
    """For every element: the conditional over all K categories is the normalised marginal joint."""
    trials, rule, priors, state, _ = case
    explained = given.explained_words(rule, state.F, c, len(trials.word_trial))
    for i in range(len(state.z[c])):
        weights = collapsed.assignment_log_weights(trials, c, priors[c], state.z[c], explained, i)
        joint = []
        for k in range(priors[c].categories):
            z = state.z[c].copy()
            z[i] = k
            change = with_channel(state, "z", c, z)
            joint.append(log_marginal_joint(trials, rule, priors, change.z, change.F))
        assert np.diff(weights) == pytest.approx(np.diff(joint), rel=1e-9, abs=1e-8)
        assert np.ptp(joint) > 1e-3


@pytest.mark.parametrize("longest", [1, 4])
def test_collapsed_frames(case: Case, longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """For every sentence, or part of it: the conditional over all frames is the normalised marginal joint."""
    trials, rule, priors, state, _ = case
    monkeypatch.setattr(collapsed, "LONGEST_PART", longest)
    if rule == "every":
        assert (
            collapsed.draw_frames(np.random.default_rng(0), trials, "every", priors, state.z, state.F, 1.0).size == 0
        )
        return
    allowed = collapsed.allowed_frames(rule, trials)
    size, spread = allowed.frames.shape[1], 0.0
    for first, last in zip(trials.sentence_bounds[:-1], trials.sentence_bounds[1:], strict=True):
        for start in range(int(first), int(last), size):
            length = min(size, int(last) - start)
            weights = collapsed.frame_log_weights(trials, rule, priors, state.z, state.F, start, length)
            frames = allowed.frames[allowed.bounds[length] : allowed.bounds[length + 1], :length]
            assert len(weights) == len(frames) > 1
            joint = []
            for frame in frames:
                F = state.F.copy()
                F[start : start + length] = frame
                joint.append(log_marginal_joint(trials, rule, priors, state.z, F))
            assert np.diff(weights) == pytest.approx(np.diff(joint), rel=1e-9, abs=1e-8)
            spread = max(spread, float(np.ptp(joint)))
    assert spread > 1e-3


def test_statistics_of_a_sweep_are_those_computed_anew(case: Case) -> None:
    """Rank-one updates and downdates over a sweep, against everything computed from the last state."""
    trials, rule, priors, state, rng = case
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        explained = given.explained_words(rule, state.F, c, len(trials.word_trial))
        features = np.tile(channel.features, (20, 1)) + rng.normal(size=(20 * len(channel.features), channel.dim))
        words, (order, bounds) = trials.words[c], trials.words_by_element[c]
        bounds = np.concatenate([bounds, np.full(len(features) - len(channel.features), bounds[-1])])
        z = rng.integers(prior.categories, size=len(features))
        gaussian, counts = prior.gaussian(channel.dim), np.zeros((prior.categories, len(trials.vocabulary)))
        for t in np.flatnonzero(explained):
            counts[z[trials.word_speaker[c][t]], words[t]] += 1
        elements = Elements(features, words, order, bounds, explained, gaussian, 0.3, prior.word_concentration)
        carried, moved = channel_statistics(elements, counts, z), z.copy()
        sweep(rng, elements, carried, moved, 1.0)
        anew = channel_statistics(elements, carried.words, moved)
        assert np.count_nonzero(moved != z) > len(z) // 8
        for one, other in zip(carried.law, anew.law, strict=True):
            assert one == pytest.approx(other, rel=1e-9, abs=1e-12)
        assert carried.constant == pytest.approx(anew.constant, rel=1e-9)
        assert carried.word_totals == pytest.approx(anew.word_totals)


def test_marginal_joint_is_joint_over_conditionals(case: Case) -> None:
    """Candidate's formula (Chib 1995): p(X, w, z, F) = p(…, π, φ, θ) / p(π, φ, θ | …), for any π, φ, θ."""
    trials, rule, priors, state, _ = case
    total = log_joint(trials, rule, priors, state)
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        explained = given.explained_words(rule, state.F, c, len(trials.word_trial))
        concentration = given.word_concentration(trials, c, prior, state.z[c], explained)
        total -= given.weights_log_density(prior, state.z[c], state.log_weights[c])
        total -= given.categories_log_density(prior, channel, state.z[c], state.mean[c], state.factor[c])
        total -= given.words_log_density(concentration, state.log_words[c])
    assert log_marginal_joint(trials, rule, priors, state.z, state.F) == pytest.approx(total, rel=1e-9, abs=1e-8)
