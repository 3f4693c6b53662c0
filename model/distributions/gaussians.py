"""The Gaussian-inverse-Wishart distribution: posterior and draws.

A covariance exists only as its Cholesky factor; there is no explicit inverse and no determinant.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints
from model.distributions.triangular import factorise
from model.prior import GaussianPrior

# χ² variates of nearly no degree of freedom underflow; the floor keeps covariances finite.
_SMALLEST_SQUARE = 1e-200


class GaussianInverseWishart(NamedTuple):
    """K Gaussian-inverse-Wishart distributions GIW(m, κ, V, ν).

    Attributes:
        counts: (K,) the number of points n behind each; a category without any has the prior.
        mean: (K, dim) m.
        mean_precision: (K,) κ.
        upper: (K, dim, dim) U with V = Uᵀ U; below the diagonal 0.
        degrees_of_freedom: (K,) ν.
    """

    counts: Floats
    mean: Floats
    mean_precision: Floats
    upper: Floats
    degrees_of_freedom: Floats


@compiled
def fit_category(posterior: GaussianInverseWishart, k: int, prior: GaussianPrior, features: Floats, z: Ints) -> None:
    """Set category k of `posterior` to its posterior given the points with z = k, as Algorithm 1 draws from it."""
    dim = features.shape[1]
    centre, upper = np.empty(dim), posterior.upper[k]
    count = set_scatter(features, z, k, prior.scale, centre, upper)
    posterior.counts[k] = count
    posterior.mean_precision[k] = prior.mean_precision + count
    posterior.degrees_of_freedom[k] = prior.degrees_of_freedom + count
    if count == 0:
        posterior.mean[k] = prior.mean
        for j in range(dim):
            upper[j, j] = prior.scale**0.5
        return
    posterior.mean[k] = (prior.mean_precision * prior.mean + count * centre) / posterior.mean_precision[k]
    add_square(upper, centre - prior.mean, prior.mean_precision * count / posterior.mean_precision[k])
    factorise(upper, prior.scale)


@compiled
def set_scatter(features: Floats, z: Ints, k: int, scale: float, centre: Floats, upper: Floats) -> int:
    """Set `centre` (dim,) to the mean of the points with z = k, and `upper` to V0 plus their scatter about it.

    Args:
        features: (N, dim).
        z: (N,) categories.
        k: A category.
        scale: V0 = scale · I.
        centre: (dim,); 0 without points.
        upper: (dim, dim), of which the upper triangle is set, and 0 below it.

    Returns:
        The number of points.
    """
    count, dim = 0, features.shape[1]
    centre[:], upper[:] = 0.0, 0.0
    for j in range(dim):
        upper[j, j] = scale
    for i in range(len(z)):
        if z[i] == k:
            count += 1
            centre += features[i]
    if count == 0:
        return count
    centre /= count
    deviation = np.empty(dim)
    for i in range(len(z)):
        if z[i] == k:
            for j in range(dim):
                deviation[j] = features[i, j] - centre[j]
            add_square(upper, deviation, 1.0)
    return count


@compiled
def add_square(matrix: Floats, vector: Floats, weight: float) -> None:
    """Add weight · v vᵀ to the upper triangle of a matrix."""
    dim = len(vector)
    for j in range(dim):
        target, source, share = matrix[j, j:], vector[j:], weight * vector[j]
        for i in range(dim - j):
            target[i] += share * source[i]


@compiled
def gaussian_posterior(features: Floats, z: Ints, K: int, prior: GaussianPrior) -> GaussianInverseWishart:
    """Posterior of the K Gaussians of a channel given features (N, dim) and categories z (N,)."""
    dim = features.shape[1]
    posterior = GaussianInverseWishart(
        np.empty(K), np.empty((K, dim)), np.empty(K), np.empty((K, dim, dim)), np.empty(K)
    )
    for k in range(K):
        fit_category(posterior, k, prior, features, z)
    return posterior


@compiled
def draw_posterior_gaussians(
    rng: np.random.Generator, features: Floats, z: Ints, K: int, averaged_draws: int, prior: GaussianPrior
) -> tuple[Floats, Floats]:
    """Draw μ (K, dim) and the lower Cholesky factor of Σ (K, dim, dim) from `gaussian_posterior`."""
    return draw_gaussians(rng, gaussian_posterior(features, z, K, prior), averaged_draws)


@compiled
def draw_gaussians(
    rng: np.random.Generator, posterior: GaussianInverseWishart, averaged_draws: int
) -> tuple[Floats, Floats]:
    """Draw μ (K, dim) and the lower Cholesky factor of Σ (K, dim, dim) from K GIW distributions.

    Σ by Bartlett's decomposition: with V = L Lᵀ and a lower triangular R, R_ii² ~ χ²(ν − dim + 1 + i)
    for i = 0..dim−1 and standard normal below the diagonal, Σ = C Cᵀ with C = L R⁻¹ ~ IW(V, ν).

    Args:
        rng: The fit's generator.
        posterior: The K distributions.
        averaged_draws: μ is the mean of this many draws given Σ. Above 1 this is not Gibbs sampling
            any more (docs/model.md, The samplers).
    """
    K, dim = posterior.mean.shape
    mean, factor = np.empty((K, dim)), np.zeros((K, dim, dim))
    R, noise = np.zeros((dim, dim)), np.empty(dim)
    for k in range(K):
        for i in range(dim):
            for j in range(i):
                R[i, j] = rng.standard_normal()
            square = 2.0 * rng.standard_gamma((posterior.degrees_of_freedom[k] - dim + 1 + i) / 2.0)
            R[i, i] = max(square, _SMALLEST_SQUARE) ** 0.5
        # The mean of n standard normal draws is one draw of variance 1/n.
        spread = 1.0 / (posterior.mean_precision[k] * averaged_draws) ** 0.5
        for i in range(dim):
            noise[i] = spread * rng.standard_normal()
        for i in range(dim):
            _divide_row(posterior.upper[k], i, R, factor[k, i])
            shift = 0.0
            for j in range(i + 1):
                shift += factor[k, i, j] * noise[j]
            mean[k, i] = posterior.mean[k, i] + shift
    return mean, factor


@compiled
def _divide_row(upper: Floats, i: int, R: Floats, row: Floats) -> None:
    """Set row i of C (dim,) so that C R = L, with L = Uᵀ and R lower triangular."""
    for j in range(i + 1):
        row[j] = upper[j, i]
    for j in range(i, -1, -1):
        row[j] /= R[j, j]
        share, source = row[j], R[j]
        for m in range(j):
            row[m] -= share * source[m]
