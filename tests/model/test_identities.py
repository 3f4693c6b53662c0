"""Exact identities: each conditional is proportional to the joint. No sampling noise, no tolerance to tune."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from model import Prior, Problem, State, Trials
from model.distributions.dirichlet import dirichlet_log_density, draw_log_dirichlet
from model.joint import draw_parameters, log_joint, log_marginal_joint
from model.kernels import collapsed_frames, words
from model.kernels import conditionals as given
from model.kernels.collapsed_assignments import channel_statistics, elements_of, sweep
from model.state import Partition
from tests.model import conditional_densities as conditional

Case = tuple[Problem, State, np.random.Generator]


@pytest.fixture
def case(trials: Trials, method: str, priors: tuple[Prior, ...], rng: np.random.Generator) -> Case:
    problem = Problem.of(trials, method, priors)
    if not problem.frame_prior.has_frames:  # Each channel has a sentence of its own, as the model says.
        own = rng.integers(len(trials.vocabulary), size=trials.words.shape)
        problem = replace(problem, trials=replace(trials, words=own))
    return problem, draw_parameters(rng, problem), rng


def with_channel(state: State, field: str, c: int, value: object) -> State:
    """The state with one channel's part of a field replaced."""
    parts = list(getattr(state, field))
    parts[c] = value
    return replace(state, **{field: tuple(parts)})


def assert_ratio(case: Case, change: State, log_conditional: Callable[[State], float]) -> None:
    """Log p(new) − log p(old) is the same by the conditional and by the joint."""
    problem, state, _ = case
    by_joint = log_joint(problem, change) - log_joint(problem, state)
    by_conditional = log_conditional(change) - log_conditional(state)
    assert by_conditional == pytest.approx(by_joint, rel=1e-9, abs=1e-8)
    assert abs(by_joint) > 1e-3  # the two states do differ


@pytest.mark.parametrize("c", range(3))
def test_assignments(case: Case, c: int) -> None:
    problem, state, rng = case
    weights = given.assignment_log_weights(problem, c, state)
    z = rng.permutation(np.arange(len(state.z[c])) % problem.priors[c].categories)
    rows = np.arange(len(z))
    assert_ratio(case, with_channel(state, "z", c, z), lambda s: float(np.sum(weights[rows, s.z[c]])))


@pytest.mark.parametrize("c", range(3))
def test_weights(case: Case, c: int) -> None:
    problem, state, rng = case
    prior = problem.priors[c]
    change = with_channel(state, "log_weights", c, given.draw_weights(rng, prior, state.z[c]))
    assert_ratio(case, change, lambda s: conditional.weights_log_density(prior, s.z[c], s.log_weights[c]))


@pytest.mark.parametrize("c", range(3))
def test_categories(case: Case, c: int) -> None:
    problem, state, rng = case
    mean, factor = given.draw_categories(rng, problem, c, state.z[c])
    change = with_channel(with_channel(state, "mean", c, mean), "factor", c, factor)
    assert_ratio(
        case, change, lambda s: conditional.categories_log_density(problem, c, s.z[c], s.mean[c], s.factor[c])
    )


def test_frames(case: Case) -> None:
    problem, state, rng = case
    if not problem.frame_prior.has_frames:
        assert state.F.size == 0
        return
    weights = words.word_log_weights(problem, state.z, state.log_words)
    drawn = (problem.frame_prior.draw(rng, problem.trials) for _ in range(50))
    # Of the draws one that does not merely let two tokens of one word change places.
    before = log_joint(problem, state)
    F = next(one for one in drawn if abs(log_joint(problem, replace(state, F=one)) - before) > 0.1)
    assert_ratio(case, replace(state, F=F), lambda s: conditional.frames_log_probability(problem, weights, s.F))


@pytest.mark.parametrize("c", range(3))
def test_words(case: Case, c: int) -> None:
    problem, state, rng = case
    concentration = words.word_concentration(problem, c, state.z[c], state.F)
    change = with_channel(state, "log_words", c, draw_log_dirichlet(rng, concentration, 1))
    assert_ratio(case, change, lambda s: dirichlet_log_density(s.log_words[c], concentration))


@pytest.mark.parametrize("c", range(3))
def test_collapsed_assignments(case: Case, c: int) -> None:
    """For every element: the conditional over all K categories is the normalised marginal joint."""
    problem, state, _ = case
    for i in range(len(state.z[c])):
        weights = conditional.element_log_weights(problem, c, state.z[c], state.F, i)
        joint = []
        for k in range(problem.priors[c].categories):
            z = state.z[c].copy()
            z[i] = k
            joint.append(log_marginal_joint(problem, with_channel(state, "z", c, z)))
        assert np.diff(weights) == pytest.approx(np.diff(joint), rel=1e-9, abs=1e-8)
        assert np.ptp(joint) > 1e-3


@pytest.mark.parametrize("longest", [1, 4])
def test_collapsed_frames(case: Case, longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """For every sentence, or part of it: the conditional over all frames is the normalised marginal joint."""
    problem, state, rng = case
    trials = problem.trials
    monkeypatch.setattr(collapsed_frames, "MOST_JOINT_WORDS", longest)
    if not problem.frame_prior.has_frames:
        assert collapsed_frames.sweep_frames(rng, problem, state.z, state.F, 1.0).size == 0
        return
    if problem.paths is not None and problem.paths.once:  # Nothing is listed there: tests/model/test_sentences.py.
        assert problem.frame_prior.joint_words(trials.longest_sentence, longest) == trials.longest_sentence
        return
    allowed = problem.frame_prior.listed(trials, longest)
    size, spread = allowed.frames.shape[1], 0.0
    for first, last in zip(trials.sentence_bounds[:-1], trials.sentence_bounds[1:], strict=True):
        for start in range(int(first), int(last), size):
            length = min(size, int(last) - start)
            weights = conditional.part_log_weights(problem, state.z, state.F, start, length)
            frames = allowed.frames[allowed.bounds[length] : allowed.bounds[length + 1], :length]
            assert len(weights) == len(frames) > 1
            joint = []
            for frame in frames:
                F = state.F.copy()
                F[start : start + length] = frame
                joint.append(log_marginal_joint(problem, Partition(state.z, F)))
            assert np.diff(weights) == pytest.approx(np.diff(joint), rel=1e-9, abs=1e-8)
            spread = max(spread, float(np.ptp(joint)))
    assert spread > 1e-3


def test_statistics_of_a_sweep_are_those_computed_anew(case: Case) -> None:
    """Rank-one updates and downdates over a sweep, against everything computed from the last state."""
    problem, state, rng = case
    for c, (channel, prior) in enumerate(zip(problem.trials.channels, problem.priors, strict=True)):
        own = elements_of(problem, c, state.F)
        features = np.tile(channel.features, (20, 1)) + rng.normal(size=(20 * len(channel.features), channel.dim))
        bounds = np.concatenate([own.bounds, np.full(len(features) - len(channel.features), own.bounds[-1])])
        z = rng.integers(prior.categories, size=len(features))
        counts = np.zeros((prior.categories, len(problem.trials.vocabulary)))
        for t in np.flatnonzero(own.explained):
            counts[z[problem.trials.word_speaker[c][t]], own.words[t]] += 1
        elements = own._replace(features=features, bounds=bounds, weight=0.3)
        carried, moved = channel_statistics(elements, counts, z), z.copy()
        sweep(rng, elements, carried, moved, 1.0)
        anew = channel_statistics(elements, carried.words, moved)
        assert np.count_nonzero(moved != z) > len(z) // 8
        for one, other in zip(carried.posterior, anew.posterior, strict=True):
            assert one == pytest.approx(other, rel=1e-9, abs=1e-12)
        assert carried.constant == pytest.approx(anew.constant, rel=1e-9)
        assert carried.word_totals == pytest.approx(anew.word_totals)


def test_marginal_joint_is_joint_over_conditionals(case: Case) -> None:
    """Candidate's formula (Chib 1995): p(X, w, z, F) = p(…, π, φ, θ) / p(π, φ, θ | …), for any π, φ, θ."""
    problem, state, _ = case
    total = log_joint(problem, state)
    for c, prior in enumerate(problem.priors):
        concentration = words.word_concentration(problem, c, state.z[c], state.F)
        total -= conditional.weights_log_density(prior, state.z[c], state.log_weights[c])
        total -= conditional.categories_log_density(problem, c, state.z[c], state.mean[c], state.factor[c])
        total -= dirichlet_log_density(state.log_words[c], concentration)
    if problem.frame_prior.has_none:
        total -= dirichlet_log_density(state.log_words[-1], words.none_concentration(problem, state.F))
    assert log_marginal_joint(problem, state) == pytest.approx(total, rel=1e-9, abs=1e-8)
