"""Frames along paths against every frame listed, and the conditionals of words of no channel against the joint."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy import stats
from scipy.special import logsumexp

from model import METHODS, SAMPLERS, Mixing, Prior, Problem, Trials, fit, load, save
from model.data import Floats, Ints
from model.frame_paths import Paths, paths_of
from model.joint import log_marginal_joint
from model.kernels.collapsed_paths import sentence_log_end, source_log_weights
from model.kernels.frame_paths import count_states, draw_path, end_log_weights, last_state, mark_free, path_log_sums
from model.kernels.word_table import count_part, word_table
from model.open_frames import Once
from model.prediction import spoken_order
from model.state import Partition
from tests.synthetic import trials_of_model

PRIORS = {name: METHODS[name].frame_prior for name in ("proposed_open", "proposed_ordered", "proposed_open_ordered")}
CASES = [(name, C, N) for name in PRIORS for C in range(2, 6) for N in range(7) if N <= PRIORS[name].word_limit(C)]


def once(name: str) -> Once:
    prior = PRIORS[name]
    assert isinstance(prior, Once)
    return prior


def lone(N: int, C: int) -> Trials:
    """One trial with a sentence of N words and C channels."""
    own = trials_of_model(np.random.default_rng(0), [1], [N])
    channels = (own.channels * 2)[:C]
    return replace(own, channels=channels, words=np.tile(own.words[0], (C, 1)))


@pytest.mark.parametrize(("name", "C", "N"), CASES)
def test_sums_along_paths_are_those_over_all_frames(name: str, C: int, N: int) -> None:
    prior, rng = once(name), np.random.default_rng([C, N])
    paths = paths_of(C, 6, prior.none, prior.ordered)
    log_weights = 3.0 * rng.normal(size=(N, C + 1))
    counts = rng.integers(4, size=len(paths.size)) * (paths.size <= N)
    log_end = end_log_weights(paths, N, counts)
    if not prior.none:
        log_weights[:, C] = -np.inf
    frames = prior.allowed(C, N)
    ends = np.array([last_state(paths, frame, 0, N) for frame in frames], dtype=np.int64)
    assert len(frames) == prior.count(C, N) == len(np.unique(frames, axis=0))
    # The frames' probabilities, counted or not, add up to 1.
    assert logsumexp(log_end[ends]) == pytest.approx(0.0, abs=1e-9)
    listed = log_end[ends] + log_weights[np.arange(N), frames].sum(axis=1)
    assert logsumexp(path_log_sums(paths, log_weights)[N] + log_end) == pytest.approx(logsumexp(listed))


@pytest.mark.parametrize(("name", "C", "N"), [("proposed_open", 3, 4), ("proposed_open_ordered", 3, 3)])
def test_draws_along_paths_have_the_frames_probabilities(name: str, C: int, N: int) -> None:
    prior, rng = once(name), np.random.default_rng(5)
    paths = paths_of(C, N, prior.none, prior.ordered)
    log_weights = rng.normal(size=(N, C + 1))
    counts = rng.integers(6, size=len(paths.size))
    log_end, frames = end_log_weights(paths, N, counts), prior.allowed(C, N)
    listed = np.array([log_end[last_state(paths, f, 0, N)] + log_weights[np.arange(N), f].sum() for f in frames])
    p, frame, draws = np.exp(listed - logsumexp(listed)), np.zeros(N, dtype=np.int64), Counter[tuple[int, ...]]()
    for _ in range(20_000):
        assert draw_path(rng, paths, log_weights, log_end, frame) == pytest.approx(logsumexp(listed))
        draws[tuple(frame.tolist())] += 1
    observed = np.array([draws[tuple(f.tolist())] for f in frames])
    assert observed.sum() == 20_000
    often = 20_000 * p >= 5
    # One more bin for all rare frames.
    seen, expected = (np.append(own[often], own[~often].sum() + 1.0) for own in (observed, 20_000 * p))
    assert stats.chisquare(seen, expected).pvalue > 1e-4


def test_nothing_is_drawn_where_nothing_is_possible() -> None:
    paths, frame = paths_of(2, 3, False, False), np.array([7, 7, 7])
    impossible = np.full((3, 3), -np.inf)
    assert draw_path(np.random.default_rng(0), paths, impossible, paths.log_prior[3], frame) == -np.inf
    assert frame.tolist() == [7, 7, 7]


@pytest.mark.parametrize("name", PRIORS)
def test_the_prior_of_one_sentence_is_as_defined(name: str) -> None:
    prior, C = once(name), 3
    for N in range(4):
        total = 0.0
        for frame in prior.allowed(C, N):
            j = int(np.count_nonzero(frame < C))
            places = 1.0 / (min(C, N) + 1) / math.comb(N, j) if prior.none else 1.0
            log_p = prior.log_probability(lone(N, C), frame)
            assert log_p == pytest.approx(math.log(places / math.perm(C, j)))  # an order is as any other, at first
            total += math.exp(log_p)
        assert total == pytest.approx(1.0)


@pytest.mark.parametrize("name", [*PRIORS, "no_mec2_open"])
def test_drawn_frames_have_the_probability_that_is_stated(name: str) -> None:
    """Also of several sentences, which share λ."""
    trials, prior = trials_of_model(np.random.default_rng(0), [1, 1], [2, 2]), METHODS[name].frame_prior
    trials = replace(trials, channels=trials.channels[:2], words=trials.words[:2])
    rng = np.random.default_rng(1)
    drawn = Counter(tuple(prior.draw(rng, trials).tolist()) for _ in range(20_000))
    frames = [np.concatenate(pair) for pair in product(prior.allowed(2, 2), repeat=2)]
    p = np.exp([prior.log_probability(trials, F) for F in frames])
    assert p.sum() == pytest.approx(1.0)
    observed = np.array([drawn[tuple(F.tolist())] for F in frames])
    assert observed.sum() == 20_000
    assert stats.chisquare(observed, 20_000 * p).pvalue > 1e-4


def test_orders_said_before_are_more_probable() -> None:
    """λ with δ = 1 of two orders: the second sentence's is the first's with probability (1 + ½) / (1 + 1)."""
    trials = trials_of_model(np.random.default_rng(0), [1, 1], [2, 2])
    trials = replace(trials, channels=trials.channels[:2], words=trials.words[:2])
    prior = once("proposed_ordered")
    assert prior.log_probability(trials, np.array([0, 1, 0, 1])) == pytest.approx(math.log(0.5 * 0.75))
    assert prior.log_probability(trials, np.array([0, 1, 1, 0])) == pytest.approx(math.log(0.5 * 0.25))


def log_frame_weight(paths: Paths, log_weights: Floats, log_end: Floats, frame: Ints) -> float:
    return float(log_end[last_state(paths, frame, 0, len(frame))] + log_weights[np.arange(len(frame)), frame].sum())


@pytest.mark.parametrize("name", PRIORS)
def test_collapsed_frames_along_paths(name: str) -> None:
    """For every sentence: the conditional over all its frames, held tokens as they are, is the marginal joint."""
    lengths = [3, 2, 3] if name == "proposed_ordered" else [5, 2, 4]
    trials = trials_of_model(np.random.default_rng(2), [1, 2, 2], lengths, W=2)  # two words: many are said twice
    rng = np.random.default_rng(4)
    problem, prior = Problem.of(trials, name, Prior(categories=2, word_concentration=0.4)), once(name)
    z = tuple(rng.integers(2, size=len(channel.features)) for channel in trials.channels)
    F, paths, words = prior.draw(rng, trials), problem.paths, trials.words[0]
    assert paths is not None
    for first, last in zip(trials.sentence_bounds[:-1].tolist(), trials.sentence_bounds[1:].tolist(), strict=True):
        table, counts = word_table(problem, z, F), count_states(paths, F, trials.sentence_bounds)
        counts[last_state(paths, F, first, last)] -= 1
        count_part(table, words, F, first, last - first, -1.0)
        free = np.ones(last - first, dtype=np.bool_)
        if prior.none:
            mark_free(rng, words, first, last, True, free)
            assert sorted(words[first:last][free].tolist()) == sorted(set(words[first:last].tolist()))
        log_weights = source_log_weights(table, words, F, first, last, free, paths)
        log_end = sentence_log_end(table, last - first, counts, paths)
        weights, joint = [], []
        for frame in prior.allowed(3, last - first):
            weights.append(log_frame_weight(paths, log_weights, log_end, frame))
            changed = np.concatenate([F[:first], frame, F[last:]])
            held = np.array_equal(changed[first:last][~free], F[first:last][~free])
            joint.append(log_marginal_joint(problem, Partition(z, changed)) if held else -np.inf)
        possible = np.isfinite(joint)
        assert np.array_equal(np.isfinite(weights), possible)
        assert np.count_nonzero(possible) > 1
        difference = np.array(weights)[possible] - np.array(joint)[possible]
        assert difference == pytest.approx(difference[0], abs=1e-9)
        assert np.ptp(np.array(joint)[possible]) > 1e-3


@pytest.mark.parametrize("at_random", [True, False])
def test_one_token_of_each_word_is_free(at_random: bool) -> None:
    words, rng = np.array([9, 4, 3, 4, 4, 3, 9]), np.random.default_rng(0)
    chosen = Counter[tuple[int, ...]]()
    for _ in range(2000):
        free = np.zeros(5, dtype=np.bool_)
        mark_free(rng, words, 1, 6, at_random, free)
        chosen[tuple(np.flatnonzero(free).tolist())] += 1
    if not at_random:
        assert set(chosen) == {(0, 1)}
        return
    pairs = [(0, 1), (0, 4), (1, 2), (2, 4), (1, 3), (3, 4)]
    assert set(chosen) == set(pairs)
    assert stats.chisquare([chosen[pair] for pair in pairs]).pvalue > 1e-4


def test_long_sentences_are_refused_only_where_every_word_needs_a_channel(trials: Trials) -> None:
    longer = trials_of_model(np.random.default_rng(0), [1, 2], [40, 3])
    for name in ("proposed_open", "proposed_open_ordered", "no_mec2_open"):
        F = METHODS[name].frame_prior.draw(np.random.default_rng(1), longer)
        assert np.isfinite(METHODS[name].frame_prior.log_probability(longer, F))
        assert Problem.of(longer, name).sources == 4
    with pytest.raises(ValueError, match=r"more than 3 words .* use proposed_open"):
        Problem.of(longer, "proposed_ordered")
    assert Problem.of(trials, "proposed_ordered").sources == 3


def with_fillers(order: tuple[int, ...] | None, D: int = 24) -> tuple[Trials, Ints]:
    """Trials with a word each for action and color, in an order or any, among six that say nothing; and the truth."""
    rng = np.random.default_rng(3)
    labels = rng.integers(3, size=(2, D))
    features = [np.eye(3)[own] + 0.05 * rng.standard_normal((D, 3)) for own in labels]
    sentences, F = [], []
    for d in range(D):
        said = [(f"filler{w}", 2) for w in rng.integers(5, size=6)]
        for place, c in zip(
            np.sort(rng.integers(7, size=2)), rng.permutation(2) if order is None else order, strict=True
        ):
            said.insert(int(place) + len(said) - 6, (f"{'ac'[c]}{labels[c, d]}", int(c)))
        sentences.append([word for word, _ in said])
        F += [c for _, c in said]
    trials = Trials.from_arrays(features[0], {"color": features[1]}, range(D), [0] * D, sentences)
    return trials, np.array(F, dtype=np.int64)


@pytest.mark.parametrize("kind", SAMPLERS)
@pytest.mark.parametrize("name", ["proposed_open", "proposed_open_ordered"])
def test_words_of_no_channel_are_found(name: str, kind: str) -> None:
    trials, truth = with_fillers(None)
    priors = Prior(categories=4, mean_precision=0.1)
    found = fit(Problem.of(trials, name, priors), SAMPLERS[kind](iterations=60), np.random.default_rng(5))
    assert found.summary is not None
    assert found.summary.marginals is not None
    assert found.summary.marginals.shape == (len(truth), 3)
    assert np.mean(found.summary.channels == truth) > 0.95
    fillers = [w for w, word in enumerate(trials.vocabulary) if word.startswith("filler")]
    assert np.exp(found.state.log_words[-1][0, fillers]).sum() > 0.9


def test_an_order_is_learned_and_stored(tmp_path: Path) -> None:
    trials, _ = with_fillers((1, 0))
    sampler = Mixing(iterations=60)
    found = fit(
        Problem.of(trials, "proposed_open_ordered", Prior(categories=4, mean_precision=0.1)),
        sampler,
        np.random.default_rng(5),
    )
    assert spoken_order(found) == ("color", "action")
    save(found, tmp_path / "fit.npz")
    with np.load(tmp_path / "fit.npz") as stored:
        assert stored["orders"].tolist() == [[-1, -1], [0, -1], [1, -1], [0, 1], [1, 0]]
        assert stored["lambda"][4] > 0.9
        assert stored["theta_none"].shape == (1, len(trials.vocabulary))
    assert spoken_order(load(tmp_path / "fit.npz")) == ("color", "action")
