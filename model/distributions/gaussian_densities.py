"""Log densities of features under Gaussians, of Gaussians under their distribution, and of features alone."""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats
from model.distributions.gaussians import GaussianInverseWishart
from model.distributions.triangular import half_log_determinant, squared_length
from model.prior import GaussianPrior

_LOG_2 = math.log(2.0)
_LOG_PI = math.log(math.pi)
# Elements are handled in blocks of this size, whose intermediate results stay in the innermost cache.
_BLOCK = 64


@compiled
def gaussian_log_density(features: Floats, mean: Floats, factor: Floats) -> Floats:
    """(N, K) log N(x_n | μ_k, C_k C_kᵀ) of features (N, dim): forward substitution, many elements at a time."""
    N, dim = features.shape
    K = len(mean)
    result = np.empty((N, K))
    columns, white, square = np.empty((dim, _BLOCK)), np.empty((dim, _BLOCK)), np.empty(_BLOCK)
    for start in range(0, N, _BLOCK):
        size = min(_BLOCK, N - start)
        for n in range(size):
            for i in range(dim):
                columns[i, n] = features[start + n, i]
        for k in range(K):
            _squared_distances(columns, size, mean[k], factor[k], white, square)
            constant = -half_log_determinant(factor[k]) - 0.5 * dim * (_LOG_2 + _LOG_PI)
            for n in range(size):
                result[start + n, k] = constant - 0.5 * square[n]
    return result


@compiled
def _squared_distances(
    columns: Floats, size: int, mean: Floats, factor: Floats, white: Floats, square: Floats
) -> None:
    """Set square[n] = |C⁻¹ (x_n − μ)|² for the first `size` columns x_n of (dim, block).

    Four rows of `white` are taken at a time, which keeps the row under way in registers.
    """
    square[:size] = 0.0
    for i in range(len(mean)):
        row, source, centre, coefficients = white[i, :size], columns[i, :size], mean[i], factor[i]
        for n in range(size):
            row[n] = source[n] - centre
        whole = i - i % 4
        for j in range(0, whole, 4):
            c0, c1, c2, c3 = coefficients[j], coefficients[j + 1], coefficients[j + 2], coefficients[j + 3]
            row0, row1 = white[j, :size], white[j + 1, :size]
            row2, row3 = white[j + 2, :size], white[j + 3, :size]
            for n in range(size):
                row[n] -= (c0 * row0[n] + c1 * row1[n]) + (c2 * row2[n] + c3 * row3[n])
        for j in range(whole, i):
            c0, row0 = coefficients[j], white[j, :size]
            for n in range(size):
                row[n] -= c0 * row0[n]
        inverse = 1.0 / coefficients[i]
        for n in range(size):
            row[n] *= inverse
            square[n] += row[n] * row[n]


@compiled
def giw_log_density(posterior: GaussianInverseWishart, mean: Floats, factor: Floats) -> Floats:
    """(K,) log density of μ and Σ = C Cᵀ under GIW(m, κ, V, ν), with respect to dμ dΣ."""
    K, dim = mean.shape
    result = np.empty(K)
    for k in range(K):
        nu, kappa = posterior.degrees_of_freedom[k], posterior.mean_precision[k]
        # Rows of Cᵀ for `squared_length`; the columns of L are the rows of U.
        sigma = factor[k].T.copy()
        half_log_sigma = half_log_determinant(sigma)
        trace = 0.0
        for j in range(dim):
            trace += squared_length(sigma, posterior.upper[k, j].copy())
        wishart = nu * half_log_determinant(posterior.upper[k]) - (nu + dim + 1) * half_log_sigma - 0.5 * trace
        wishart -= 0.5 * nu * dim * _LOG_2 + log_multivariate_gamma(nu / 2.0, dim)
        normal = 0.5 * dim * (math.log(kappa) - _LOG_2 - _LOG_PI) - half_log_sigma
        result[k] = wishart + normal - 0.5 * kappa * squared_length(sigma, mean[k] - posterior.mean[k])
    return result


@compiled
def log_multivariate_gamma(a: float, dim: int) -> float:
    """Log Γ_dim(a), a > (dim − 1) / 2."""
    total = 0.25 * dim * (dim - 1) * _LOG_PI
    for j in range(dim):
        total += math.lgamma(a - 0.5 * j)
    return total


@compiled
def gaussian_log_marginal(prior: GaussianPrior, posterior: GaussianInverseWishart) -> float:
    """Log density of the features behind `posterior`, the posterior, given z, all μ and Σ integrated out."""
    dim = posterior.mean.shape[1]
    before = log_multivariate_gamma(prior.degrees_of_freedom / 2.0, dim)
    before -= 0.5 * dim * (prior.degrees_of_freedom * math.log(prior.scale) + math.log(prior.mean_precision))
    total = 0.0
    for k in range(len(posterior.mean)):
        if posterior.counts[k] > 0.0:
            after = log_multivariate_gamma(posterior.degrees_of_freedom[k] / 2.0, dim) - 0.5 * dim * math.log(
                posterior.mean_precision[k]
            )
            after -= posterior.degrees_of_freedom[k] * half_log_determinant(posterior.upper[k])
            total += after - 0.5 * dim * posterior.counts[k] * _LOG_PI - before
    return total
