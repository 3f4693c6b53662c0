"""What kept states say together: against direct sums, and against every partition there is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from model import (
    METHODS,
    Collapsed,
    Fit,
    History,
    Mixing,
    Prior,
    Problem,
    Sampler,
    Trials,
    fit,
    load,
    save,
    summaries,
)
from model.data import Ints
from model.history import evenly
from model.kernels.means import posterior_means
from model.kernels.variation import descend, expected_variation
from model.kernels.words import word_concentration
from model.prediction import describe, understand
from model.state import Partition, State
from model.summaries import aligned, canonical, co_assignments, point_estimate, summarise

Kind = type[Sampler[Any]]
SETTINGS = ("draw", "mean", "average")

MODELS = [name for name, method in METHODS.items() if method.is_model]


def partitions(count: int) -> Iterator[Ints]:
    """Every partition of so many elements, each once."""

    def grow(start: list[int]) -> Iterator[Ints]:
        if len(start) == count:
            yield np.array(start, dtype=np.int64)
            return
        for k in range(max(start, default=-1) + 2):
            yield from grow([*start, k])

    return grow([])


def noisy(seed: int, count: int, K: int) -> Ints:
    """(S, N) a partition, each state with other elements moved at random and other names of the categories."""
    rng = np.random.default_rng(seed)
    states = int(rng.integers(1, 30))
    moved = rng.random((states, count)) < rng.uniform(0.1, 0.9)
    z = np.where(moved, rng.integers(K, size=(states, count)), rng.integers(K, size=count))
    return np.stack([rng.permutation(K)[state] for state in z])


def variation(one: Ints, other: Ints) -> float:
    """The variation of information in nats, H(X | Y) + H(Y | X), by its definition."""
    total = 0.0
    for a in set(one.tolist()):
        for b in set(other.tolist()):
            both = np.mean((one == a) & (other == b))
            if both > 0:
                total -= both * (np.log(both / np.mean(one == a)) + np.log(both / np.mean(other == b)))
    return float(total)


def expected(states: Ints, z: Ints) -> float:
    """By compiled code, with room for as many categories as there are elements."""
    return float(expected_variation(np.ascontiguousarray(states.T), z, max(len(z), int(z.max()) + 1)))


@pytest.fixture
def long(trials: Trials, priors: tuple[Prior, ...], method: str) -> Fit:
    """A fit whose kept states differ."""
    problem = Problem.of(trials, method, priors)
    return fit(problem, Collapsed(iterations=60, keep_history=60), np.random.default_rng(3))


def with_parameters(result: Fit, parameters: str) -> Fit:
    return replace(result, sampler=result.sampler.model_copy(update={"parameters": parameters}))


def test_the_expected_variation_is_the_mean_over_the_states() -> None:
    for seed in range(20):
        states = noisy(seed, 12, 4)
        z = np.random.default_rng(seed).integers(5, size=12)
        assert expected(states, z) == pytest.approx(np.mean([variation(z, state) for state in states]))


@pytest.mark.parametrize("count", [4, 5])
def test_no_partition_varies_less_than_the_estimate(count: int) -> None:
    for seed in range(60):
        states = noisy(seed, count, 2 + seed % (count - 1))
        least = min(expected(states, one) for one in partitions(count))
        assert expected(states, point_estimate(states, count)) == pytest.approx(least, abs=1e-9)


def test_no_kept_state_varies_less_than_the_estimate() -> None:
    gains = []
    for seed in range(20):
        states = noisy(seed, 40, 5)
        found = expected(states, point_estimate(states, 5))
        gains.append(min(expected(states, state) for state in states) - found)
    assert min(gains) > -1e-9
    assert max(gains) > 0.05  # a state is one draw; the estimate pools all of them


def test_no_move_and_no_merger_betters_the_end_of_a_search() -> None:
    rng = np.random.default_rng(0)
    for seed in range(150):
        states = np.ascontiguousarray(noisy(seed, 12, 4).T)
        found = descend(states, rng.integers(6, size=12), 6)
        moved = [np.where(np.arange(12) == i, k, found) for i in range(12) for k in range(6)]
        merged = [np.where(found == a, b, found) for a in range(6) for b in range(6)]
        least = min(expected_variation(states, other, 6) for other in (*moved, *merged))
        assert least > expected_variation(states, found, 6) - 1e-9


def test_an_estimate_has_no_more_categories_than_it_may() -> None:
    """Three pairs, each together in two states of three: three categories are best, and may not fit."""
    states = np.array([[0, 0, 1, 1, 2, 2], [0, 0, 1, 1, 2, 2], [0, 0, 0, 0, 0, 0]])
    assert point_estimate(states, 3).tolist() == [0, 0, 1, 1, 2, 2]
    assert point_estimate(states[:2] % 2, 2).tolist() == [0, 0, 1, 1, 0, 0]
    for seed in range(20):
        states = noisy(seed, 10, 3)
        assert point_estimate(states, 3).max() < 3


def test_names_of_categories_mean_nothing() -> None:
    assert canonical(np.array([7, 2, 7, 0, 2])).tolist() == [0, 1, 0, 2, 1]
    states, rng = noisy(1, 15, 4), np.random.default_rng(0)
    renamed = np.stack([rng.permutation(4)[state] for state in states])
    assert point_estimate(states, 4).tolist() == point_estimate(renamed, 4).tolist()
    assert np.array_equal(co_assignments(states), co_assignments(renamed))
    reference = np.array([0, 0, 1, 1, 3, 3, 3])
    for _ in range(10):
        assert aligned(rng.permutation(5)[reference], reference, 5).tolist() == reference.tolist()
    # Where a category has no match it takes a name that is left, and none is given twice.
    found = aligned(np.array([4, 4, 4, 4, 2, 2, 1]), reference, 5).tolist()
    assert found[0] in (0, 1)
    assert found == [found[0]] * 4 + [3, 3, found[6]]
    assert len(set(found)) == 3


def test_co_assignments_are_shares_of_the_states(monkeypatch: pytest.MonkeyPatch) -> None:
    states = noisy(4, 9, 3)
    shares = (states[:, :, None] == states[:, None, :]).mean(axis=0)
    assert co_assignments(states) == pytest.approx(shares)
    monkeypatch.setattr(summaries, "LARGEST_TOGETHER", 8)
    assert co_assignments(states) is None


def test_many_elements_need_no_square_matrix() -> None:
    """10 GB would be needed for the co-assignments of these."""
    rng, truth = np.random.default_rng(0), np.arange(36_000) % 4
    states = np.where(rng.random((9, len(truth))) < 0.1, rng.integers(4, size=(9, len(truth))), truth)
    assert co_assignments(states) is None
    # Three of four moved elements change their category; more than half of nine states seldom move the same one.
    assert np.mean(point_estimate(states, 6) == truth) > 0.999
    assert np.mean(states[0] == truth) == pytest.approx(0.925, abs=0.01)


def test_marginals_are_shares_of_a_history_after_burn_in(trials: Trials) -> None:
    """Of a history that is written by hand; F of the first two states must not count."""
    problem = Problem.of(trials, "no_mec2")
    z = tuple(np.zeros((6, len(channel.features)), dtype=np.int64) for channel in trials.channels)
    F = np.zeros((6, len(trials.word_trial)), dtype=np.int64)
    F[2:, 0] = [1, 2, 2, 2]
    F[2:, 1] = [0, 0, 1, 1]
    kept = History(np.arange(1, 7), z, F).after(2)
    assert kept is not None
    summary = summarise(problem, kept)
    assert summary.marginals is not None
    assert summary.marginals[:3].tolist() == [[0.0, 0.25, 0.75], [0.5, 0.5, 0.0], [1.0, 0.0, 0.0]]
    assert summary.channels[:3].tolist() == [2, 0, 0]
    assert History(np.arange(1, 7), z, F).after(6) is None


def test_histories_are_thinned_evenly_up_to_the_last() -> None:
    assert [evenly(6, 3), evenly(5, 2), evenly(3, 9), evenly(4, 0)] == [[1, 3, 5], [1, 4], [0, 1, 2], []]


def test_expected_counts_are_the_mean_of_the_counts(long: Fit) -> None:
    """Given one z, parameters of θ are linear in the counts, so that their mean over the states is that of one."""
    assert long.kept is not None
    assert long.summary is not None
    problem, z = long.problem, long.summary.z
    state = posterior_means(problem, Partition(z, long.summary.channels), long.summary.marginals)
    for c in range(len(problem.priors)):
        mean = np.mean([word_concentration(problem, c, z[c], F) for F in long.kept.F], axis=0)
        assert np.exp(state.log_words[c]) == pytest.approx(mean / mean.sum(axis=1, keepdims=True))
        assert np.array_equal(with_parameters(long, "mean").knowledge.categories.log_words[c], state.log_words[c])


@pytest.mark.parametrize("method", MODELS)
def test_settings_of_summaries_change_no_draw(
    trials: Trials, priors: tuple[Prior, ...], method: str, kind: Kind
) -> None:
    problem, arrays = Problem.of(trials, method, priors), []
    for parameters, burn_in in zip(SETTINGS, (0.5, 0.6, 0.9), strict=True):
        sampler = kind(iterations=8, parameters=parameters, burn_in=burn_in)
        state = fit(problem, sampler, np.random.default_rng(1)).state
        arrays.append([*state.z, state.F, *state.log_weights, *state.mean, *state.factor, *state.log_words])
    for other in arrays[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(arrays[0], other, strict=True))


def test_knowledge_is_what_the_setting_names(long: Fit) -> None:
    assert with_parameters(long, "draw").knowledge.states == (long.state,)
    at_summary = with_parameters(long, "mean").knowledge
    assert len(at_summary.states) == 1
    assert long.summary is not None
    assert all(np.array_equal(a, b) for a, b in zip(at_summary.categories.z, long.summary.z, strict=True))
    assert len(with_parameters(long, "average").knowledge.states) == 30
    with pytest.raises(ValueError, match="parameters: average needs kept states"):
        _ = replace(with_parameters(long, "average"), history=None, summary=None).knowledge


def test_averaged_scores_are_means_of_probabilities(long: Fit, scene: dict[str, np.ndarray]) -> None:
    """By hand: the answers of thirty fits with the kept states as their last."""
    words = [long.trials.vocabulary[w] for w in (0, 1, 0)][:2]
    average = with_parameters(long, "average")
    alone = [replace(with_parameters(long, "draw"), state=state) for state in average.knowledge.states]
    scores = np.mean([np.exp(understand(one, scene, words).log_scores) for one in alone], axis=0)
    assert np.exp(understand(average, scene, words).log_scores) == pytest.approx(scores)
    assert len({round(float(understand(one, scene, words).log_scores[0, 0]), 9) for one in alone}) > 5
    for c, channel in enumerate(scene, start=1):
        told = []
        for row in scene[channel]:
            p = np.mean([_word_probabilities(one.state, c, row) for one in alone], axis=0)
            told.append(long.trials.vocabulary[int(np.argmax(p))])
        assert describe(average, channel, scene[channel]) == tuple(told)


def _word_probabilities(state: State, c: int, row: np.ndarray) -> np.ndarray:
    """(W,) Σ_k r_k θ_kw."""
    away = [np.linalg.solve(factor, row - mean) for mean, factor in zip(state.mean[c], state.factor[c], strict=True)]
    logs = state.log_weights[c] - [np.log(np.diag(factor)).sum() for factor in state.factor[c]]
    r = np.exp(logs - [0.5 * white @ white for white in away])
    return np.asarray((r / r.sum()) @ np.exp(state.log_words[c]))


def renamed(result: Fit, history: History) -> Fit:
    """The fit with another history, in each state of which the categories have names of their own."""
    rng, pairs = np.random.default_rng(0), zip(history.z, result.problem.priors, strict=True)
    z = tuple(np.stack([rng.permutation(prior.categories)[state] for state in part]) for part, prior in pairs)
    other = replace(result, history=replace(history, z=z))
    assert other.kept is not None
    return replace(other, summary=summarise(result.problem, other.kept))


@pytest.fixture
def scene() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(6)
    return {"position": rng.normal(size=(3, 2)), "color": rng.normal(size=(3, 1))}


@pytest.mark.parametrize("parameters", ["mean", "average"])
def test_other_names_of_categories_choose_no_other_object(
    long: Fit, scene: dict[str, np.ndarray], parameters: str
) -> None:
    assert long.history is not None
    word = long.trials.vocabulary[:1]
    before, after = (
        understand(with_parameters(one, parameters), scene, word) for one in (long, renamed(long, long.history))
    )
    assert after.probabilities.sum(axis=1) == pytest.approx(before.probabilities.sum(axis=1))


def test_categories_are_averaged_with_those_that_they_resemble(long: Fit, scene: dict[str, np.ndarray]) -> None:
    """One state again and again under other names: its average is the state itself."""
    assert long.history is not None
    again = History.of(long.history.iterations, [Partition(long.state.z, long.state.F)] * 60)
    result, word = renamed(long, again), long.trials.vocabulary[:1]
    average, mean = (understand(with_parameters(result, name), scene, word) for name in ("average", "mean"))
    assert average.log_scores == pytest.approx(mean.log_scores)
    last = understand(long, scene, word).log_scores  # of `collapsed`: at posterior means, too
    assert np.sort(average.log_scores, axis=1) == pytest.approx(np.sort(last, axis=1))


def test_chains_are_kept_to_be_compared(trials: Trials, kind: Kind) -> None:
    problem = Problem.of(trials, "proposed")
    assert fit(problem, kind(iterations=6), np.random.default_rng(2)).chains is None
    result = fit(problem, kind(iterations=6, chains=3), np.random.default_rng(2))
    assert result.chains is not None
    assert result.summary is not None
    assert result.chains.marginals is not None
    assert result.chains.used.shape == (3, 6, 3)
    assert len({tuple(trace) for trace in result.chains.log_joint}) == 3
    best = int(np.argmax(result.chains.log_joint[:, -1]))
    assert np.array_equal(result.chains.log_joint[best], result.trace_log_joint)
    assert np.array_equal(result.chains.used[best], result.trace_used)
    assert np.array_equal(result.chains.marginals[best], result.summary.marginals)
    first = fit(problem, kind(iterations=6), np.random.default_rng(2))
    assert first.summary is not None
    assert np.array_equal(result.chains.marginals[0], first.summary.marginals)
    bare = fit(problem, kind(iterations=6, chains=2, keep_history=0, parameters="draw"), np.random.default_rng(2))
    assert bare.chains is not None
    assert (bare.summary, bare.kept, bare.chains.marginals) == (None, None, None)


@pytest.mark.parametrize("method", MODELS)
@pytest.mark.parametrize("chains", [1, 2])
def test_files_carry_the_summary(trials: Trials, method: str, chains: int, tmp_path: Path) -> None:
    sampler = Collapsed(iterations=10, keep_history=10, chains=chains, parameters="average", burn_in=0.2)
    result = fit(Problem.of(trials, method), sampler, np.random.default_rng(3))
    save(result, tmp_path / "1.npz")
    again = load(tmp_path / "1.npz")
    save(again, tmp_path / "2.npz")
    assert again.summary is not None
    assert result.summary is not None
    for one, other in zip(_arrays(result), _arrays(again), strict=True):
        assert (one is None) == (other is None)
        assert one is None or (np.array_equal(one, other) and one.dtype == other.dtype)
    assert (again.chains is None) == (chains == 1)
    assert (again.summary.marginals is None) == (not METHODS[method].has_frames)
    for before, after in zip(result.knowledge.states, again.knowledge.states, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(before.log_words, after.log_words, strict=True))
    save(fit(Problem.of(trials, method), sampler, np.random.default_rng(3)), tmp_path / "3.npz")
    assert (tmp_path / "1.npz").read_bytes() == (tmp_path / "3.npz").read_bytes()


def _arrays(result: Fit) -> list[np.ndarray | None]:
    assert result.summary is not None
    own = [*result.summary.z, *result.summary.together, result.summary.marginals]
    chains = result.chains
    return own if chains is None else [*own, chains.log_joint, chains.used, chains.marginals]


def test_wrong_settings_are_refused(kind: Kind) -> None:
    for parameters in ("mean", "average"):
        with pytest.raises(ValueError, match=rf"parameters: {parameters} needs kept states"):
            kind(parameters=parameters, keep_history=0)
    with pytest.raises(ValueError, match=r"(?s)burn_in.*less than 1.*parameters"):
        kind(burn_in=1, parameters="best")
    for annealed in (Collapsed, Mixing):
        with pytest.raises(ValueError, match=r"burn_in = 0\.2 would keep annealed states \(at least 0\.[35]\)"):
            annealed(temperature=5.0, burn_in=0.2)
