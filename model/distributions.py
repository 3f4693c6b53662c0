"""The conjugate pieces of the model: Dirichlet, categorical and Gaussian-inverse-Wishart.

Everything is in log space, and a covariance exists only as its Cholesky factor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.special import gammaln, multigammaln

from model.data import Floats, Ints, Prior

LOG_2_PI = float(np.log(2.0 * np.pi))


def draw_log_dirichlet(rng: np.random.Generator, concentration: Floats) -> Floats:
    """Logarithms of Dirichlet draws along the last axis.

    Small concentrations underflow as probabilities, so log-Gamma variates are drawn, by
    Gamma(a) = Gamma(a + 1) · U^(1/a).
    """
    boosted = rng.standard_gamma(concentration + 1.0)
    log_gamma = np.log(boosted) - rng.standard_exponential(concentration.shape) / concentration
    return np.asarray(log_gamma - log_sum(log_gamma))


def log_sum(values: Floats) -> Floats:
    """Log Σ exp along the last axis, which is kept."""
    top = np.max(values, axis=-1, keepdims=True)
    return np.asarray(top + np.log(np.sum(np.exp(values - top), axis=-1, keepdims=True)))


def dirichlet_log_density(log_probabilities: Floats, concentration: Floats) -> Floats:
    """Log density of Dirichlet draws given as logarithms, along the last axis."""
    constant = gammaln(concentration.sum(axis=-1)) - gammaln(concentration).sum(axis=-1)
    return np.asarray(constant + np.sum((concentration - 1.0) * log_probabilities, axis=-1))


def draw_categorical(rng: np.random.Generator, log_weights: Floats) -> Ints:
    """One index a row of (N, K) unnormalised log weights, by the inverse of the cumulative sum."""
    weights = np.exp(log_weights - log_weights.max(axis=1, keepdims=True))
    cumulative = np.cumsum(weights, axis=1)
    threshold = rng.random((len(weights), 1)) * cumulative[:, -1:]
    # The threshold is below the total, so that the sum stays within the row.
    return np.asarray(np.sum(cumulative <= threshold, axis=1, dtype=np.int64))


def count_log_marginal(counts: Floats, concentration: float) -> float:
    """Log probability of draws with these counts along the last axis, the symmetric Dirichlet integrated out."""
    size = counts.shape[-1]
    per_row = gammaln(size * concentration) - gammaln(size * concentration + counts.sum(axis=-1))
    return float(np.sum(per_row) + np.sum(gammaln(counts + concentration) - gammaln(concentration)))


@dataclass(frozen=True)
class GaussianInverseWishart:
    """K Gaussian-inverse-Wishart distributions GIW(m, κ, V, ν).

    Attributes:
        mean: (K, dim) m.
        strength: (K,) κ.
        scale_factor: (K, dim, dim) lower Cholesky factor of V.
        freedom: (K,) ν.
    """

    mean: Floats
    strength: Floats
    scale_factor: Floats
    freedom: Floats


def gaussian_posterior(prior: Prior, features: Floats, z: Ints) -> GaussianInverseWishart:
    """Posterior of the K Gaussians of a channel given its assignments (model.md, section 3, step 3).

    Args:
        prior: GIW(m0, κ0, V0, ν0) of the channel.
        features: (N, dim).
        z: (N,) categories. An empty category keeps the prior.
    """
    K, dim = prior.categories, features.shape[1]
    counts = np.bincount(z, minlength=K).astype(np.float64)
    strength = prior.mean_strength + counts
    mean = np.full((K, dim), prior.mean)
    scale = np.zeros((K, dim, dim))
    scale[:, np.arange(dim), np.arange(dim)] = prior.scale
    for k in np.flatnonzero(counts):
        points = features[z == k]
        centre = points.mean(axis=0)
        deviation = points - centre
        offset = centre - prior.mean
        weight = prior.mean_strength * counts[k] / strength[k]
        scale[k] += deviation.T @ deviation + weight * np.outer(offset, offset)
        mean[k] = (prior.mean_strength * prior.mean + counts[k] * centre) / strength[k]
    freedom = dim + prior.extra_freedom + counts
    return GaussianInverseWishart(mean, strength, np.asarray(np.linalg.cholesky(scale), dtype=np.float64), freedom)


def draw_gaussians(
    rng: np.random.Generator, law: GaussianInverseWishart, averaged_draws: int = 1
) -> tuple[Floats, Floats]:
    """Draw μ (K, dim) and the lower Cholesky factor of Σ (K, dim, dim) from K GIW distributions.

    Σ by Bartlett's decomposition: with V = L Lᵀ and a lower triangular R, R_ii² ~ χ²(ν − dim + 1 + i)
    for i = 0..dim−1 and standard normal below the diagonal, Σ = C Cᵀ with C = L R⁻¹ ~ IW(V, ν).

    Args:
        rng: the fit's generator.
        law: the K distributions.
        averaged_draws: μ is the mean of so many draws given Σ. Above 1 this is not Gibbs sampling
            any more (model.md, section 3, choices).
    """
    K, dim = law.mean.shape
    diagonal, below = np.arange(dim), np.tril_indices(dim, -1)
    R = np.zeros((K, dim, dim))
    R[:, below[0], below[1]] = rng.standard_normal((K, len(below[0])))
    chi_square = 2.0 * rng.standard_gamma((law.freedom[:, None] - dim + 1 + diagonal) / 2.0)
    R[:, diagonal, diagonal] = np.sqrt(chi_square)
    noise = rng.standard_normal((K, dim))
    mean, factor = np.empty((K, dim)), np.empty((K, dim, dim))
    for k in range(K):
        factor[k] = dtrsm(1.0, R[k], law.scale_factor[k], side=1, lower=1)
        # The mean of n standard normal draws is one draw of variance 1/n.
        mean[k] = law.mean[k] + factor[k] @ noise[k] / np.sqrt(law.strength[k] * averaged_draws)
    return mean, factor


def gaussian_log_density(features: Floats, mean: Floats, factor: Floats) -> Floats:
    """(N, K) log N(x_n | μ_k, C_k C_kᵀ) of features (N, dim)."""
    N, dim = features.shape
    result = np.empty((N, len(mean)))
    for k in range(len(mean)):
        white = dtrsm(1.0, factor[k], (features - mean[k]).T, lower=1)
        log_determinant = np.sum(np.log(np.diagonal(factor[k])))
        result[:, k] = -0.5 * np.einsum("ij,ij->j", white, white) - log_determinant - 0.5 * dim * LOG_2_PI
    return result


def giw_log_density(law: GaussianInverseWishart, mean: Floats, factor: Floats) -> Floats:
    """(K,) log density of μ and Σ = C Cᵀ under GIW(m, κ, V, ν), with respect to dμ dΣ."""
    K, dim = mean.shape
    result = np.empty(K)
    for k in range(K):
        nu = law.freedom[k]
        half_log_scale = np.sum(np.log(np.diagonal(law.scale_factor[k])))
        half_log_sigma = np.sum(np.log(np.diagonal(factor[k])))
        trace = np.sum(dtrsm(1.0, factor[k], law.scale_factor[k], lower=1) ** 2)
        wishart = nu * half_log_scale - (nu + dim + 1) * half_log_sigma - 0.5 * trace
        wishart -= 0.5 * nu * dim * np.log(2.0) + float(multigammaln(nu / 2.0, dim))
        white = dtrsm(1.0, factor[k], (mean[k] - law.mean[k])[:, None], lower=1)
        normal = 0.5 * dim * (np.log(law.strength[k]) - LOG_2_PI) - half_log_sigma
        result[k] = wishart + normal - 0.5 * law.strength[k] * np.sum(white**2)
    return result


def gaussian_log_marginal(prior: Prior, features: Floats, z: Ints) -> float:
    """Log density of a channel's features given z, all μ and Σ integrated out."""
    before = gaussian_posterior(prior, features[:0], z[:0])
    after = gaussian_posterior(prior, features, z)
    gain = np.sum(_log_normaliser(after) - _log_normaliser(before))
    return float(gain - 0.5 * features.size * np.log(np.pi))


def _log_normaliser(law: GaussianInverseWishart) -> Floats:
    """(K,) log of Γ_dim(ν/2) |V|^(−ν/2) κ^(−dim/2)."""
    dim = law.mean.shape[1]
    half_log_scale = np.sum(np.log(np.diagonal(law.scale_factor, axis1=1, axis2=2)), axis=1)
    return np.asarray(
        multigammaln(law.freedom / 2.0, dim) - law.freedom * half_log_scale - 0.5 * dim * np.log(law.strength)
    )
