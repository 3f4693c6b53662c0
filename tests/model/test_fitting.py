"""Fits from outside: arguments, determinism, chains, annealing, files."""

from __future__ import annotations

import doctest
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from model import METHODS, Fit, Prior, Settings, State, Trials, collapsed, conditionals, fit, fitting, load, save
from model.fitting import INFERENCE, annealed
from model.joint import log_marginal_joint
from model.omission import kept_words
from model.state import Partition

Sampler = Any


@pytest.fixture(params=INFERENCE)
def inference(request: pytest.FixtureRequest) -> Sampler:
    return request.param


def arrays_of(state: State) -> list[np.ndarray]:
    return [*state.z, *state.log_weights, *state.mean, *state.factor, *state.log_words, state.F]


@pytest.mark.parametrize("method", METHODS)
def test_trace_is_the_log_joint_and_the_state_its_last(
    trials: Trials, priors: tuple[Prior, ...], method: str, inference: Sampler
) -> None:
    result = fit(trials, method, np.random.default_rng(3), priors, iterations=6, inference=inference, keep_history=3)
    rule, history = METHODS[method].rule, result.history
    assert history is not None
    assert history.iterations.tolist() == [2, 4, 6]
    for h, iteration in enumerate(history.iterations):
        z = tuple(part[h] for part in history.z)
        expected = log_marginal_joint(trials, rule, priors, z, history.F[h])
        assert result.trace_log_joint[iteration - 1] == expected
        assert result.trace_used[iteration - 1].tolist() == [len(np.unique(part)) for part in z]
    assert all(np.array_equal(part[-1], last) for part, last in zip(history.z, result.state.z, strict=True))
    assert np.array_equal(history.F[-1], result.state.F)
    for c, prior in enumerate(priors):
        assert np.exp(result.state.log_weights[c]).sum() == pytest.approx(1.0)
        assert np.exp(result.state.log_words[c]).sum(axis=1) == pytest.approx(np.ones(prior.categories))
        assert result.state.factor[c] == pytest.approx(np.tril(result.state.factor[c]))


def test_same_seed_same_fit_and_another_seed_another(trials: Trials, inference: Sampler) -> None:
    one, same, other = (
        fit(trials, "proposed", np.random.default_rng(s), iterations=5, inference=inference) for s in (1, 1, 2)
    )
    assert all(np.array_equal(a, b) for a, b in zip(arrays_of(one.state), arrays_of(same.state), strict=True))
    assert not np.array_equal(one.trace_log_joint, other.trace_log_joint)
    assert one.sampler["seed"] != other.sampler["seed"]


def test_the_best_chain_is_kept(trials: Trials, inference: Sampler) -> None:
    """Chains do not depend on each other: the first of eight is the one that runs alone."""
    alone = fit(trials, "no_mec2", np.random.default_rng(1), iterations=5, inference=inference)
    best = fit(trials, "no_mec2", np.random.default_rng(1), iterations=5, chains=8, inference=inference)
    assert best.trace_log_joint[-1] > alone.trace_log_joint[-1]
    ends = [
        fit(trials, "no_mec2", rng, iterations=5, inference=inference).trace_log_joint[-1]
        for rng in (_Spawned(chain) for chain in np.random.default_rng(1).spawn(8))
    ]
    assert best.trace_log_joint[-1] == max(ends)


class _Spawned:
    """A generator that stands for the one that `fit` would spawn."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng, self.bit_generator = rng, rng.bit_generator

    def spawn(self, count: int) -> list[np.random.Generator]:
        assert count == 1
        return [self.rng]


def test_collapsed_fit_ends_with_posterior_means(trials: Trials, priors: tuple[Prior, ...]) -> None:
    """Against the mean of many draws of the blocked sampler's conditionals, given the same z and F."""
    state = fit(trials, "proposed", np.random.default_rng(3), priors, iterations=5, inference="collapsed").state
    rng = np.random.default_rng(4)
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        weights = [np.exp(conditionals.draw_weights(rng, prior, state.z[c])) for _ in range(4000)]
        assert np.mean(weights, axis=0) == pytest.approx(np.exp(state.log_weights[c]), abs=0.02)
        explained = state.F == c
        concentration = conditionals.word_concentration(trials, c, prior, state.z[c], explained)
        words = [np.exp(conditionals.draw_words(rng, concentration)) for _ in range(4000)]
        assert np.mean(words, axis=0) == pytest.approx(np.exp(state.log_words[c]), abs=0.03)
        stiff = replace(prior, extra_degrees_of_freedom=40.0)
        partition = Partition(state.z, state.F)
        means = collapsed.posterior_means(trials, "proposed", (stiff,) * 3, partition)
        draws = [conditionals.draw_categories(rng, stiff, channel, state.z[c], Settings()) for _ in range(4000)]
        covariance = np.mean([factor @ factor.transpose(0, 2, 1) for _, factor in draws], axis=0)
        expected = means.factor[c] @ means.factor[c].transpose(0, 2, 1)
        assert covariance[: prior.categories] == pytest.approx(expected[: prior.categories], rel=0.1, abs=0.002)


def test_parameters_stay_finite_where_no_mean_exists(trials: Trials) -> None:
    prior = Prior(extra_degrees_of_freedom=0.5)
    state = fit(trials, "proposed", np.random.default_rng(0), prior, iterations=2, inference="collapsed").state
    assert all(np.all(np.isfinite(array)) for array in arrays_of(state))


def test_temperature_falls_linearly_over_the_first_half() -> None:
    assert [annealed(5.0, i, 8) for i in range(8)] == [5.0, 4.0, 3.0, 2.0, 1.0, 1.0, 1.0, 1.0]
    assert [annealed(5.0, 0, 1), annealed(1.0, 0, 10)] == [1.0, 1.0]


def test_hot_chains_are_indifferent(trials: Trials, priors: tuple[Prior, ...]) -> None:
    """At a temperature without limit each category is as probable as any other."""
    rng, state = np.random.default_rng(1), collapsed.init(np.random.default_rng(0), trials, "distinct", priors)
    shares = np.zeros(4)
    for _ in range(500):
        state = collapsed.step(rng, state, trials, "distinct", priors, temperature=1e9)
        shares += np.bincount(state.z[1], minlength=4)
    assert shares / shares.sum() == pytest.approx(np.full(4, 0.25), abs=0.03)


def test_everything_wrong_is_named_at_once(trials: Trials) -> None:
    with pytest.raises(
        ValueError, match=r"method 'best'.*inference 'fast'.*2 priors for 3.*iterations = 0.*keep_history"
    ):
        fit(
            trials,
            "best",
            np.random.default_rng(0),
            [Prior(), Prior()],
            iterations=0,
            inference="fast",
            keep_history=-1,
        )
    with pytest.raises(ValueError, match="temperature applies to inference collapsed"):
        fit(trials, "proposed", np.random.default_rng(0), temperature=2.0)
    with pytest.raises(ValueError, match="settings apply to inference blocked"):
        fit(trials, "proposed", np.random.default_rng(0), settings=Settings(100), inference="collapsed")


def test_long_sentences_are_refused_where_no_frame_exists(trials: Trials, inference: Sampler) -> None:
    long = replace(trials, word_trial=np.zeros(6, dtype=np.int64))
    with pytest.raises(ValueError, match=r"1 sentences have more than 3 words \(rows 0 of"):
        fit(long, "proposed", np.random.default_rng(0), inference=inference)
    assert fit(long, "no_mec2", np.random.default_rng(0), iterations=2, inference=inference).state.F.size == 6


def test_wrong_arrays_are_all_named() -> None:
    with pytest.raises(ValueError, match=r"color are \(2, 1\), not \(3.*attended\[1\] = 4, but trial 1 has 2"):
        Trials.from_arrays(np.zeros((2, 1)), {"color": np.zeros((2, 1))}, [0, 1, 1], [0, 4], [[], []])
    with pytest.raises(ValueError, match=r"action are not all finite \(row 1\)"):
        Trials.from_arrays(np.array([[0.0], [np.nan]]), {"color": np.zeros((2, 1))}, [0, 1], [0, 0], [[], []])
    with pytest.raises(
        ValueError, match=r"hyperparameters: mean = inf.*scale = 0.*extra_degrees_of_freedom = -1.*box = \(1, 0\)"
    ):
        Prior(mean=np.inf, scale=0, extra_degrees_of_freedom=-1, box=(1, 0))
    with pytest.raises(ValueError, match="averaged_draws = 0"):
        Settings(averaged_draws=0)


@pytest.mark.parametrize("method", METHODS)
def test_files(trials: Trials, method: str, inference: Sampler, tmp_path: Path) -> None:
    first, second = tmp_path / "1.npz", tmp_path / "2.npz"
    result = fit(trials, method, np.random.default_rng(3), iterations=4, inference=inference, keep_history=2)
    save(result, first)
    again = Fit.load(first)
    again.save(second)
    for one, other in zip(arrays_of(result.state), arrays_of(again.state), strict=True):
        assert other == pytest.approx(one, rel=1e-9)
    assert (again.method, again.priors, again.sampler) == (method, result.priors, result.sampler)
    assert again.sampler["inference"] == inference
    assert again.trials.vocabulary == trials.vocabulary
    assert np.array_equal(again.trace_log_joint, result.trace_log_joint)
    assert again.history is not None
    assert result.history is not None
    assert np.array_equal(again.history.F, result.history.F)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1.npz", "2.npz"]
    save(result, second)
    assert first.read_bytes() == second.read_bytes()


def test_damaged_files_are_refused_by_name(trials: Trials, tmp_path: Path) -> None:
    path = tmp_path / "fit.npz"
    save(fit(trials, "proposed", np.random.default_rng(3), iterations=2), path)
    whole = path.read_bytes()
    for damaged in (
        b"",
        b"nonsense",
        whole[:100],
        whole[: len(whole) // 2],
        whole.replace(b"trace_used", b"trace_usee"),
    ):
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"fit\.npz is not a readable fit"):
            load(path)


def test_the_example_of_the_docstring_runs() -> None:
    result = doctest.testmod(fitting)
    assert result.attempted > 0
    assert result.failed == 0


def test_progress_counts_all_chains(trials: Trials) -> None:
    seen: list[tuple[int, int]] = []
    fit(trials, "mmlda", np.random.default_rng(0), iterations=3, chains=2, progress=lambda i, n: seen.append((i, n)))
    assert seen == [(i, 6) for i in range(1, 7)]


def test_averaged_draws_change_the_result(trials: Trials) -> None:
    one = fit(trials, "proposed", np.random.default_rng(1), iterations=3)
    many = fit(trials, "proposed", np.random.default_rng(1), iterations=3, settings=Settings(100, "uniform"))
    assert not np.array_equal(one.trace_log_joint, many.trace_log_joint)


def test_uniform_means_of_empty_categories_lie_in_the_box(trials: Trials) -> None:
    prior = Prior(categories=30, box=(-0.5, 0.5))
    settings = Settings(empty_category="uniform")
    for c, channel in enumerate(trials.channels):
        z = np.zeros(len(channel.features), dtype=np.int64)
        mean, _ = conditionals.draw_categories(np.random.default_rng(c), prior, channel, z, settings)
        assert np.abs(mean[1:]).max() <= 0.5 < np.abs(mean[1:]).max() + 0.05


def test_a_higher_rate_omits_a_superset() -> None:
    kept = [kept_words(np.random.default_rng(1), 80, rate) for rate in (0, 20, 40, 100)]
    assert [int(k.sum()) for k in kept] == [80, 64, 48, 0]
    assert all(np.all(more | ~less) for more, less in pairwise(kept))
