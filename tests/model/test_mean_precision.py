"""κ0 learned: its conditionals, the posterior of tiny models summed over its values, and the joint distribution."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import logsumexp

from model import SAMPLERS, Mixing, Prior, Problem, Sampler, fit, load, save
from model.data import Floats
from model.distributions.gaussian_densities import gaussian_log_marginal
from model.distributions.gaussians import gaussian_posterior
from model.fitting import prepare
from model.joint import draw_parameters, log_joint, log_marginal_joint
from model.kernels import mean_precision
from model.kernels.mean_precision import draw_given_gaussians, draw_given_partition, features_log_marginals
from model.state import Partition
from tests.model.samplers import EXACT, HEARING, quantities, tiny_trials
from tests.model.stat_asserts import LIMIT, assert_means, assert_same_distribution, distances
from tests.model.test_joint_distribution import alternating, independent

# One channel that learns κ0, and one that is told.
PRIORS = (
    Prior(
        categories=2,
        mean_precision="learned",
        mean_precision_range=(0.2, 2.0),
        scale=0.5,
        extra_degrees_of_freedom=3.0,
        word_concentration=0.3,
    ),
    Prior(categories=2, mean_precision=0.7, scale=0.5, extra_degrees_of_freedom=3.0, word_concentration=0.3),
)
BOTH = (PRIORS[0], PRIORS[0].model_copy(update={"mean_precision_range": (0.3, 3.0)}))
VALUES = PRIORS[0].mean_precisions


def tiny(method: str, priors: tuple[Prior, ...] = PRIORS) -> Problem:
    return Problem.of(tiny_trials([2, 1, 1], [2, 1, 1], W=2), method, priors)


def test_the_values_of_kappa_are_ten_per_decade() -> None:
    assert Prior(mean_precision=0.3).mean_precisions == (0.3,)
    values = Prior(mean_precision="learned").mean_precisions
    assert (len(values), values[0], values[-1]) == (51, 0.0001, 10.0)
    assert np.allclose(np.diff(np.log10(values)), 0.1, atol=1e-5)
    assert Prior(mean_precision="learned", mean_precision_range=(0.5, 0.5)).mean_precisions == (0.5,)
    with pytest.raises(ValueError, match="the smaller number comes first"):
        Prior(mean_precision_range=(1.0, 0.1))


def test_a_problem_has_the_learned_kappa_only_where_it_is_learned() -> None:
    problem = tiny("proposed")
    assert problem.learns
    assert problem.mean_precision == (VALUES[5], 0.7)
    assert problem.given([1.5, 1.5]).mean_precision == (1.5, 0.7)
    assert [prior.mean_precision for prior in problem.given([1.5, 1.5]).gaussians] == [1.5, 0.7]
    assert problem.log_hyperprior == pytest.approx(-np.log(len(VALUES)))
    assert not tiny("proposed", (PRIORS[1],) * 2).learns


@pytest.mark.parametrize("dim", [1, 3])
def test_densities_differ_between_values_as_the_marginals_do(dim: int) -> None:
    rng, values = np.random.default_rng(4), np.array([0.01, 0.5, 3.0])
    features, z = rng.normal(2.0, 1.0, size=(7, dim)), np.array([0, 0, 2, 0, 2, 3, 0])
    priors = [PRIORS[0].gaussian(dim, kappa) for kappa in values]
    right = [gaussian_log_marginal(prior, gaussian_posterior(features, z, 4, prior)) for prior in priors]
    found = features_log_marginals(features, z, 4, priors[0], values)
    assert np.allclose(np.diff(found), np.diff(right), rtol=1e-10)


def shares(draw: Callable[[np.random.Generator], Problem], count: int = 6000) -> Floats:
    """(1, count, G) which value of the first channel each of many draws has."""
    rng = np.random.default_rng(6)
    drawn = np.array([draw(rng).mean_precision[0] for _ in range(count)])
    return np.asarray(drawn[:, None] == np.array(VALUES), dtype=np.float64)[None]


@pytest.mark.parametrize("power", [1.0, 0.4])
def test_draws_given_a_partition_follow_its_marginal(power: float) -> None:
    rng, problem = np.random.default_rng(5), tiny("no_mec2")
    state = draw_parameters(rng, problem)
    given = [problem.given([kappa, 0.0]) for kappa in VALUES]
    if power == 1.0:
        log_p = np.array([log_marginal_joint(one, state) for one in given])
    else:
        features = problem.trials.channels[0].features
        marginals = [
            gaussian_log_marginal(g, gaussian_posterior(features, state.z[0], 2, g))
            for g in (one.gaussians[0] for one in given)
        ]
        log_p = power * np.array(marginals)
    exact = np.exp(log_p - logsumexp(log_p))
    assert_means(shares(lambda one: draw_given_partition(one, problem, state, power)), exact)


def test_draws_given_gaussians_follow_the_joint() -> None:
    rng, problem = np.random.default_rng(5), tiny("no_mec2")
    state = draw_parameters(rng, problem)
    log_p = np.array([log_joint(problem.given([kappa, 0.0]), state) for kappa in VALUES])
    exact = np.exp(log_p - logsumexp(log_p))
    assert exact.max() < 0.6  # else there would be nothing to see
    assert_means(shares(lambda one: draw_given_gaussians(one, problem, state)), exact)


@pytest.mark.parametrize("kind", sorted(EXACT))
def test_kernel_and_joint_agree(kind: str) -> None:
    assert_same_distribution(alternating("no_mec2", BOTH, kind, 3000), independent("no_mec2", BOTH, kind, 3000))


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(EXACT))
@pytest.mark.parametrize("method", HEARING)
def test_kernel_and_joint_agree_closely(method: str, kind: str) -> None:
    assert_same_distribution(alternating(method, BOTH, kind, 10_000), independent(method, BOTH, kind, 10_000))


def broken(right: Callable[..., Any]) -> Callable[..., Any]:
    """Draws among the values as if the data said the opposite."""
    return lambda *arguments: -right(*arguments)


@pytest.mark.parametrize("kind", ["collapsed", "mixing"])
def test_a_wrong_conditional_is_noticed(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = independent("no_mec2", BOTH, kind, 3000)
    monkeypatch.setattr(mean_precision, "features_log_marginals", broken(features_log_marginals))
    error = expected.std(axis=0) / np.sqrt(len(expected))
    walked = alternating("no_mec2", BOTH, kind, 3000)
    assert distances(walked, expected.mean(axis=0), error).max() > LIMIT


def enumerated(problem: Problem) -> Floats:
    """The expected quantities over every z and F and every κ0 of the first channel."""
    rows, log_p = [], []
    pairs, single = (problem.frame_prior.allowed(2, words).tolist() for words in (2, 1))
    sizes = [len(channel.features) for channel in problem.trials.channels]
    for pair, one, other in product(pairs, single, single):
        F = np.array([*pair, *one, *other], dtype=np.int64)
        for labels in product(range(2), repeat=sum(sizes)):
            state = Partition((np.array(labels[: sizes[0]]), np.array(labels[sizes[0] :])), F)
            for kappa in VALUES:
                given = problem.given([kappa, 0.0])
                rows.append(quantities(given, state))
                log_p.append(log_marginal_joint(given, state))
    p = np.exp(np.array(log_p) - logsumexp(log_p))
    return np.asarray(p @ np.array(rows))


@pytest.mark.slow
@pytest.mark.parametrize("kind", sorted(EXACT))
def test_posterior_is_the_exact_one(kind: str) -> None:
    rng, sampler, problem = np.random.default_rng(7), EXACT[kind], tiny("proposed")
    state, values = sampler.init(rng, problem), []
    for i in range(6000):
        problem = sampler.learn(rng, problem, state, i)
        state = sampler.step(rng, problem, state, i)
        values.append(quantities(problem, Partition(state.z, state.F)))  # what the states of all samplers have
    walked = np.array(values)[None]
    moving = np.ptp(walked[0], axis=0) > 1e-9
    assert_means(walked[:, :, moving], enumerated(problem)[moving])


@pytest.mark.parametrize("parameters", ["draw", "mean", "average"])
@pytest.mark.parametrize("kind", sorted(SAMPLERS))
def test_a_fit_that_learns_is_the_same_after_saving(kind: str, parameters: Any, tmp_path: Path) -> None:
    sampler: Sampler[Any] = SAMPLERS[kind](iterations=12, keep_history=4, parameters=parameters)
    fitted = fit(tiny("no_mec2"), sampler, np.random.default_rng(3))
    trace = fitted.trace_mean_precision
    assert trace is not None
    assert trace.shape == (12, 2)
    assert set(trace[:, 0]) <= set(VALUES)
    assert set(trace[:, 1]) == {0.7}
    assert len(set(trace[:, 0])) > 1
    assert fitted.problem.mean_precision == tuple(trace[-1])
    assert fitted.trace_log_joint[-1] == pytest.approx(log_marginal_joint(fitted.problem, fitted.state), abs=1e-8)
    save(fitted, tmp_path / "one.npz")
    again = load(tmp_path / "one.npz")
    assert again.problem.mean_precision == fitted.problem.mean_precision
    for one, other in zip(again.knowledge.states, fitted.knowledge.states, strict=True):
        assert np.allclose(one.mean[0], other.mean[0], rtol=1e-12)
    assert again.trace_mean_precision is not None
    assert again.trace_mean_precision.tobytes() == trace.tobytes()


def test_tables_follow_kappa() -> None:
    """The mixing sampler's tables of a chain that learns are those of its state, computed anew."""
    prepare()
    rng, sampler, problem = np.random.default_rng(9), Mixing(iterations=40), tiny("proposed", BOTH)
    state: Any = sampler.init(rng, problem)
    for i in range(40):
        problem = sampler.learn(rng, problem, state, i)
        state = sampler.step(rng, problem, state, i)
        plain = Partition(state.z, state.F)
        assert sampler.log_joint(problem, state) == pytest.approx(log_marginal_joint(problem, plain), abs=1e-8)
