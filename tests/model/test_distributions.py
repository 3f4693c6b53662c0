"""The conjugate pieces against SciPy and against numerical integration."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from model import Prior
from model.data import Floats, Ints
from model.distributions import dirichlet, gaussian_densities, gaussians
from model.distributions.gaussians import GaussianInverseWishart
from model.distributions.predictive import student_constant, student_log_density
from model.log_space import log_sum


def posterior_of(prior: Prior, features: Floats, z: Ints) -> GaussianInverseWishart:
    return gaussians.gaussian_posterior(
        features, z, prior.categories, prior.gaussian(features.shape[1], prior.mean_precisions[0])
    )


def scale_of(posterior: GaussianInverseWishart, k: int) -> Floats:
    return np.asarray(posterior.upper[k].T @ posterior.upper[k])


@pytest.mark.parametrize("dim", [1, 2, 5])
def test_giw_density_is_scipys(dim: int) -> None:
    rng = np.random.default_rng(dim)
    prior = Prior(categories=3, mean=0.2, mean_precision=0.7, scale=0.4, extra_degrees_of_freedom=1.5)
    features, z = rng.normal(size=(9, dim)), np.array([0, 0, 0, 0, 0, 2, 2, 2, 2])
    posterior = posterior_of(prior, features, z)
    mean, factor = gaussians.draw_gaussians(rng, posterior, 1)
    for k in range(3):
        sigma = factor[k] @ factor[k].T
        scale = scale_of(posterior, k)
        expected = stats.invwishart(posterior.degrees_of_freedom[k], scale).logpdf(sigma)
        expected += stats.multivariate_normal(posterior.mean[k], sigma / posterior.mean_precision[k]).logpdf(mean[k])
        assert gaussian_densities.giw_log_density(posterior, mean, factor)[k] == pytest.approx(expected)
        density = stats.multivariate_normal(mean[k], sigma).logpdf(features)
        assert gaussian_densities.gaussian_log_density(features, mean, factor)[:, k] == pytest.approx(density)


def test_posterior_is_that_of_the_specification() -> None:
    """V_n by its formula, written out with plain sums."""
    rng = np.random.default_rng(5)
    prior = Prior(categories=2, mean=0.5, mean_precision=0.3, scale=0.2)
    x = rng.normal(size=(6, 3))
    posterior = posterior_of(prior, x, np.ones(6, dtype=np.int64))
    m0, kappa, n = np.full(3, 0.5), 0.3, 6
    V = 0.2 * np.eye(3) + x.T @ x + kappa * np.outer(m0, m0)
    m = (kappa * m0 + x.sum(axis=0)) / (kappa + n)
    V -= (kappa + n) * np.outer(m, m)
    assert scale_of(posterior, 1) == pytest.approx(V)
    assert posterior.mean[1] == pytest.approx(m)
    assert (posterior.mean_precision[1], posterior.degrees_of_freedom[1]) == (
        pytest.approx(6.3),
        pytest.approx(3 + 2 + 6),
    )
    assert posterior.upper[0] == pytest.approx(np.sqrt(0.2) * np.eye(3))


@pytest.mark.parametrize("dim", [1, 3])
def test_drawn_gaussians_have_the_moments_of_the_distribution(dim: int) -> None:
    rng = np.random.default_rng(3)
    prior = Prior(categories=1000, mean=1.0, mean_precision=4.0, scale=0.6, extra_degrees_of_freedom=8.0)
    posterior = posterior_of(prior, np.empty((0, dim)), np.empty(0, np.int64))
    draws = [gaussians.draw_gaussians(rng, posterior, 1) for _ in range(20)]
    mean, factor = (np.concatenate(parts) for parts in zip(*draws, strict=True))
    sigma = factor @ factor.transpose(0, 2, 1)
    expected = 0.6 / (dim + 8.0 - dim - 1) * np.eye(dim)
    error = sigma.std(axis=0) / np.sqrt(len(sigma))
    assert np.all(np.abs(sigma.mean(axis=0) - expected) < 5 * error)
    assert np.all(np.abs(mean.mean(axis=0) - 1.0) < 5 * mean.std(axis=0) / np.sqrt(len(mean)))
    assert np.cov(mean.T).reshape(dim, dim) == pytest.approx(expected / 4.0, abs=0.05 * expected[0, 0])
    assert factor == pytest.approx(np.tril(factor))
    # The last diagonal element tells the degrees of freedom of Bartlett's rows apart from their reverse.
    reference = stats.invwishart(dim + 8.0, 0.6 * np.eye(dim)).rvs(20_000, random_state=7).reshape(-1, dim, dim)
    for i in range(dim):
        assert stats.ks_2samp(sigma[:, i, i], reference[:, i, i]).pvalue > 1e-4


def test_averaged_draws_narrow_the_mean_only() -> None:
    prior = Prior(categories=1000, mean_precision=1.0, extra_degrees_of_freedom=8.0)
    posterior = posterior_of(prior, np.empty((0, 1)), np.empty(0, np.int64))
    one, factor_one = gaussians.draw_gaussians(np.random.default_rng(1), posterior, 1)
    many, factor_many = gaussians.draw_gaussians(np.random.default_rng(1), posterior, 100)
    assert factor_many == pytest.approx(factor_one)
    assert many == pytest.approx(one / 10.0)


def test_log_dirichlet_does_not_underflow() -> None:
    rng = np.random.default_rng(2)
    draws = dirichlet.draw_log_dirichlet(rng, np.full((1000, 10), 1e-4), 1)
    assert np.all(np.isfinite(draws))
    assert np.exp(draws).sum(axis=1) == pytest.approx(1.0)
    means = np.exp(dirichlet.draw_log_dirichlet(rng, np.tile([0.3, 1.0, 4.0], (20_000, 1)), 1)).mean(axis=0)
    assert means == pytest.approx(np.array([0.3, 1.0, 4.0]) / 5.3, abs=0.01)


def test_dirichlet_density_is_scipys() -> None:
    concentration = np.array([0.3, 2.0, 1.1])
    p = np.array([0.2, 0.5, 0.3])
    expected = stats.dirichlet(concentration).logpdf(p)
    assert dirichlet.dirichlet_log_density(np.log(p)[None], concentration[None]) == pytest.approx(expected)


def test_categorical_follows_its_weights() -> None:
    rng = np.random.default_rng(4)
    weights = np.log([0.1, 1e-300, 0.6, 0.3]) - 1e4
    drawn = dirichlet.draw_categorical(rng, np.tile(weights, (20_000, 1)))
    shares = np.bincount(drawn, minlength=4) / 20_000
    assert shares == pytest.approx([0.1, 0.0, 0.6, 0.3], abs=0.015)


def test_averaged_log_dirichlet_is_the_log_of_the_mean() -> None:
    concentration = np.array([[0.3, 1.0, 4.0]])
    rng = np.random.default_rng(9)
    single = [np.exp(dirichlet.draw_log_dirichlet(rng, concentration, 1)) for _ in range(7)]
    assert np.exp(dirichlet.draw_log_dirichlet(np.random.default_rng(9), concentration, 7)) == pytest.approx(
        np.mean(single, axis=0)
    )


@pytest.mark.parametrize("dim", [1, 3, 7])
def test_predictive_density_is_scipys_student(dim: int) -> None:
    rng = np.random.default_rng(dim)
    prior = Prior(categories=2, mean=0.2, mean_precision=0.7, scale=0.4, extra_degrees_of_freedom=1.5)
    posterior = posterior_of(prior, rng.normal(size=(9, dim)), np.zeros(9, dtype=np.int64))
    point, kappa, nu = rng.normal(size=dim), posterior.mean_precision[0], posterior.degrees_of_freedom[0]
    shape = scale_of(posterior, 0) * (kappa + 1) / (kappa * (nu - dim + 1))
    expected = stats.multivariate_t(posterior.mean[0], shape, df=nu - dim + 1).logpdf(point)
    constant = student_constant(posterior, 0)
    assert student_log_density(posterior, 0, constant, point, np.empty(dim)) == pytest.approx(expected)


@pytest.mark.parametrize("values", [[-1000.0, -1001.0, -2000.0], [0.0, -np.inf], [-np.inf, -np.inf]])
def test_log_sums_where_probabilities_are_lost(values: list[float]) -> None:
    """Far below what exp can hold, and where nothing is left to sum."""
    given = np.array(values)
    expected = np.logaddexp.reduce(given)
    assert log_sum(given[None])[0, 0] == pytest.approx(expected, rel=1e-15)
    assert dirichlet.log_total(given) == pytest.approx(expected, rel=1e-15)
