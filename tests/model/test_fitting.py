"""Fits from outside: arguments, determinism, chains, annealing, files."""

from __future__ import annotations

import doctest
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from model import METHODS, Blocked, Collapsed, Prior, Problem, Sampler, State, Trials, fit, fitting, load, save
from model.distributions.dirichlet import draw_log_dirichlet
from model.joint import log_marginal_joint
from model.kernels import conditionals, words
from model.kernels.means import posterior_means
from model.kernels.words import word_counts
from model.omission import kept_words
from model.samplers import sampler_of
from model.samplers.collapsed import annealed
from model.state import Partition
from tests.model.samplers import TAKEN

Kind = type[Sampler[Any]]


def arrays_of(state: State) -> list[np.ndarray]:
    return [*state.z, *state.log_weights, *state.mean, *state.factor, *state.log_words, state.F, state.log_orders]


@pytest.mark.parametrize(("method", "kind"), TAKEN)
def test_trace_is_the_log_joint_and_the_state_its_last(
    trials: Trials, priors: tuple[Prior, ...], method: str, kind: Kind
) -> None:
    problem = Problem.of(trials, method, priors)
    result = fit(problem, kind(iterations=6, keep_history=3), np.random.default_rng(3))
    history = result.history
    assert history is not None
    assert history.iterations.tolist() == [2, 4, 6]
    for h, iteration in enumerate(history.iterations):
        z = tuple(part[h] for part in history.z)
        expected = log_marginal_joint(problem, Partition(z, history.F[h]))
        assert result.trace_log_joint[iteration - 1] == pytest.approx(expected, abs=1e-9)
        assert result.trace_used[iteration - 1].tolist() == [len(np.unique(part)) for part in z]
    assert all(np.array_equal(part[-1], last) for part, last in zip(history.z, result.state.z, strict=True))
    assert np.array_equal(history.F[-1], result.state.F)
    for c, prior in enumerate(priors):
        assert np.exp(result.state.log_weights[c]).sum() == pytest.approx(1.0)
        assert np.exp(result.state.log_words[c]).sum(axis=1) == pytest.approx(np.ones(prior.categories))
        assert result.state.factor[c] == pytest.approx(np.tril(result.state.factor[c]))
    assert len(result.state.log_words) == problem.sources
    assert np.exp(result.state.log_words[-1]).sum(axis=1) == pytest.approx(1.0)
    if len(result.state.log_orders):
        # λ of the orders of 0, 1, 2 and 3 channels.
        assert np.exp(result.state.log_orders).sum() == pytest.approx(4.0)


def test_only_samplers_that_need_no_model_take_what_is_none(trials: Trials, kind: Kind) -> None:
    problem = Problem.of(trials, "mmlda_released")
    if kind is Blocked:
        assert fit(problem, kind(iterations=2), np.random.default_rng(3)).state.F.shape == trials.word_trial.shape
    else:
        with pytest.raises(ValueError, match="mmlda_released is no generative model"):
            fit(problem, kind(iterations=2), np.random.default_rng(3))


def test_released_frames_stay_as_they_were_drawn(trials: Trials, priors: tuple[Prior, ...]) -> None:
    problem, sampler, rng = Problem.of(trials, "mmlda_released", priors), Blocked(), np.random.default_rng(3)
    first = state = sampler.init(rng, problem)
    for i in range(5):
        state = sampler.step(rng, problem, state, i)
    assert np.array_equal(state.F, first.F)
    assert len(set(first.F)) > 1
    for c in range(len(priors)):
        # z hears the words that F sends to its channel, θ hears all.
        assert problem.explained(state.F, c).tolist() == (state.F == c).tolist()
        assert word_counts(problem, c, state.z[c], state.F).sum() == len(trials.word_trial)


def test_a_history_is_at_most_the_chain(trials: Trials, kind: Kind) -> None:
    problem = Problem.of(trials, "mmlda")
    whole = fit(problem, kind(iterations=3), np.random.default_rng(3)).history
    assert whole is not None
    assert whole.iterations.tolist() == [1, 2, 3]
    assert (
        fit(problem, kind(iterations=3, keep_history=0, parameters="draw"), np.random.default_rng(3)).history is None
    )


def test_same_seed_same_fit_and_another_seed_another(trials: Trials, kind: Kind) -> None:
    problem = Problem.of(trials, "proposed")
    one, same, other = (fit(problem, kind(iterations=5), np.random.default_rng(s)) for s in (1, 1, 2))
    assert all(np.array_equal(a, b) for a, b in zip(arrays_of(one.state), arrays_of(same.state), strict=True))
    assert not np.array_equal(one.trace_log_joint, other.trace_log_joint)
    assert one.seed != other.seed


def test_the_best_chain_is_kept(trials: Trials, kind: Kind) -> None:
    """Chains do not depend on each other: the first of eight is the one that runs alone."""
    problem = Problem.of(trials, "no_mec2")
    alone = fit(problem, kind(iterations=5), np.random.default_rng(1))
    best = fit(problem, kind(iterations=5, chains=8), np.random.default_rng(1))
    assert best.trace_log_joint[-1] > alone.trace_log_joint[-1]
    ends = [
        fit(problem, kind(iterations=5), rng).trace_log_joint[-1]
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
    problem, rng = Problem.of(trials, "proposed", priors), np.random.default_rng(4)
    state = fit(problem, Collapsed(iterations=5), np.random.default_rng(3)).state
    stiff = replace(problem, priors=tuple(p.model_copy(update={"extra_degrees_of_freedom": 40.0}) for p in priors))
    means = posterior_means(stiff, state)
    for c, prior in enumerate(priors):
        weights = [np.exp(conditionals.draw_weights(rng, prior, state.z[c])) for _ in range(4000)]
        assert np.mean(weights, axis=0) == pytest.approx(np.exp(state.log_weights[c]), abs=0.02)
        concentration = words.word_concentration(problem, c, state.z[c], state.F)
        theta = [np.exp(draw_log_dirichlet(rng, concentration, 1)) for _ in range(4000)]
        assert np.mean(theta, axis=0) == pytest.approx(np.exp(state.log_words[c]), abs=0.03)
        draws = [conditionals.draw_categories(rng, stiff, c, state.z[c]) for _ in range(4000)]
        covariance = np.mean([factor @ factor.transpose(0, 2, 1) for _, factor in draws], axis=0)
        expected = means.factor[c] @ means.factor[c].transpose(0, 2, 1)
        assert covariance == pytest.approx(expected, rel=0.1, abs=0.002)


def test_parameters_stay_finite_where_no_mean_exists(trials: Trials) -> None:
    problem = Problem.of(trials, "proposed", Prior(extra_degrees_of_freedom=0.5))
    state = fit(problem, Collapsed(iterations=2), np.random.default_rng(0)).state
    assert all(np.all(np.isfinite(array)) for array in arrays_of(state))


def test_temperature_falls_linearly_over_the_first_half() -> None:
    assert [annealed(5.0, i, 8) for i in range(8)] == [5.0, 4.0, 3.0, 2.0, 1.0, 1.0, 1.0, 1.0]
    assert [annealed(5.0, 0, 1), annealed(1.0, 0, 10)] == [1.0, 1.0]


def test_hot_chains_are_indifferent(trials: Trials, priors: tuple[Prior, ...]) -> None:
    """At a temperature without limit each category is as probable as any other."""
    problem, hot = Problem.of(trials, "proposed", priors), Collapsed(temperature=1e6)
    rng, state = np.random.default_rng(1), hot.init(np.random.default_rng(0), problem)
    shares = np.zeros(4)
    for _ in range(500):
        state = hot.step(rng, problem, state, 0)
        shares += np.bincount(state.z[1], minlength=4)
    assert shares / shares.sum() == pytest.approx(np.full(4, 0.25), abs=0.03)


def test_wrong_problems_are_refused(trials: Trials) -> None:
    with pytest.raises(ValueError, match=r"method .best. is unknown \(there are proposed, no_mec2, mmlda, .*gmm\)"):
        Problem.of(trials, "best")
    with pytest.raises(ValueError, match="2 priors for 3 channels"):
        Problem.of(trials, "proposed", [Prior(), Prior()])


def test_everything_wrong_with_settings_is_named_at_once(kind: Kind) -> None:
    with pytest.raises(ValueError, match=r"(?s)iterations.*chains.*keep_history.*speed"):
        kind(**{"iterations": 0, "chains": 1.5, "keep_history": -1, "speed": 3})
    with pytest.raises(ValueError, match="averaged_draws"):
        Blocked(averaged_draws=0)
    with pytest.raises(ValueError, match="temperature"):
        Collapsed(temperature=0.5)
    with pytest.raises(ValueError, match=r"'fast'.*'blocked', 'collapsed'"):
        sampler_of({"kind": "fast"})


def test_settings_as_plain_data_and_back(kind: Kind) -> None:
    sampler = kind(iterations=7)
    assert sampler_of(sampler.model_dump()) == sampler
    assert sampler.stream == sampler.kind == kind(iterations=400, chains=2).stream
    assert Blocked(averaged_draws=100).stream == "blocked_averaged100"


def test_settings_are_read_without_numba() -> None:
    program = "import model.samplers, sys; sys.exit('numba' in sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_long_sentences_are_refused_where_no_frame_exists(trials: Trials, kind: Kind) -> None:
    long = replace(trials, word_trial=np.zeros(6, dtype=np.int64))
    with pytest.raises(ValueError, match=r"1 sentences have more than 3 words \(rows 0 of"):
        Problem.of(long, "proposed")
    assert fit(Problem.of(long, "no_mec2"), kind(iterations=2), np.random.default_rng(0)).state.F.size == 6


def test_wrong_arrays_are_all_named() -> None:
    with pytest.raises(ValueError, match=r"color are \(2, 1\), not \(3.*attended\[1\] = 4, but trial 1 has 2"):
        Trials.from_arrays(np.zeros((2, 1)), {"color": np.zeros((2, 1))}, [0, 1, 1], [0, 4], [[], []])
    with pytest.raises(ValueError, match=r"action are not all finite \(row 1\)"):
        Trials.from_arrays(np.array([[0.0], [np.nan]]), {"color": np.zeros((2, 1))}, [0, 1], [0, 0], [[], []])
    with pytest.raises(
        ValueError, match=r"(?s)mean\n.*finite.*scale\n.*than 0.*extra_degrees_of_freedom\n.*than -1.*box\n.*smaller"
    ):
        Prior(mean=np.inf, scale=0, extra_degrees_of_freedom=-1, box=(1, 0))


@pytest.mark.parametrize(("method", "kind"), TAKEN)
def test_files(trials: Trials, method: str, kind: Kind, tmp_path: Path) -> None:
    first, second = tmp_path / "1.npz", tmp_path / "2.npz"
    result = fit(Problem.of(trials, method), kind(iterations=4, keep_history=2), np.random.default_rng(3))
    save(result, first)
    again = load(first)
    save(again, second)
    for one, other in zip(arrays_of(result.state), arrays_of(again.state), strict=True):
        assert other == pytest.approx(one, rel=1e-9)
    assert (again.problem.method, again.problem.priors) == (METHODS[method], result.problem.priors)
    assert (again.sampler, again.seed) == (result.sampler, result.seed)
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
    save(fit(Problem.of(trials, "proposed"), Blocked(iterations=2), np.random.default_rng(3)), path)
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


def test_progress_counts_all_chains(trials: Trials, kind: Kind) -> None:
    seen: list[tuple[int, int]] = []
    sampler = kind(iterations=3, chains=2)
    fit(
        Problem.of(trials, "mmlda"), sampler, np.random.default_rng(0), lambda done, total: seen.append((done, total))
    )
    assert seen == [(i, 6) for i in range(1, 7)]


def test_averaged_draws_change_the_result(trials: Trials) -> None:
    problem = Problem.of(trials, "proposed")
    one, many = (
        fit(problem, sampler, np.random.default_rng(1))
        for sampler in (
            Blocked(iterations=3),
            Blocked(iterations=3, averaged_draws=100, empty_category="uniform"),
        )
    )
    assert not np.array_equal(one.trace_log_joint, many.trace_log_joint)


def test_uniform_means_of_empty_categories_lie_in_the_box(trials: Trials) -> None:
    problem = Problem.of(trials, "proposed", Prior(categories=30, box=(-0.5, 0.5)))
    for c, channel in enumerate(trials.channels):
        z = np.zeros(len(channel.features), dtype=np.int64)
        mean, _ = conditionals.draw_categories(np.random.default_rng(c), problem, c, z, empty_category="uniform")
        assert np.abs(mean[1:]).max() <= 0.5 < np.abs(mean[1:]).max() + 0.05


def test_a_higher_rate_omits_a_superset() -> None:
    kept = [kept_words(np.random.default_rng(1), 80, rate) for rate in (0, 20, 40, 100)]
    assert [int(k.sum()) for k in kept] == [80, 64, 48, 0]
    assert all(np.all(more | ~less) for more, less in pairwise(kept))
