"""Gaussian categories while points come and go: rank-one changes, and the predictive Student distribution."""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats
from model.distributions.gaussians import GaussianInverseWishart
from model.distributions.triangular import downdate, half_log_determinant, squared_length, update

_LOG_PI = math.log(math.pi)
# A pivot that keeps less than this share of itself has lost too many digits.
_SMALLEST_SHARE = 1e-6


@compiled
def student_constant(posterior: GaussianInverseWishart, k: int) -> float:
    """Log of the constant of the predictive density of category k.

    t_{ν−dim+1}(x | m, V (κ+1) / (κ (ν−dim+1))) = exp(constant) · (1 + κ/(κ+1) · q)^(−(ν+1)/2), q = (x−m)ᵀ V⁻¹ (x−m).
    """
    dim = posterior.mean.shape[1]
    nu, kappa = posterior.degrees_of_freedom[k], posterior.mean_precision[k]
    gammas = math.lgamma(0.5 * (nu + 1.0)) - math.lgamma(0.5 * (nu + 1.0 - dim))
    power = 0.5 * dim * (math.log(kappa / (kappa + 1.0)) - _LOG_PI)
    return float(gammas + power - half_log_determinant(posterior.upper[k]))


@compiled
def student_log_density(
    posterior: GaussianInverseWishart, k: int, constant: float, point: Floats, offset: Floats
) -> float:
    """Log predictive density of a point (dim,) under category k, see `student_constant`.

    `offset` (dim,) is working space.
    """
    for j in range(len(point)):
        offset[j] = point[j] - posterior.mean[k, j]
    kappa = posterior.mean_precision[k]
    share = kappa / (kappa + 1.0) * squared_length(posterior.upper[k], offset)
    return float(constant - 0.5 * (posterior.degrees_of_freedom[k] + 1.0) * math.log1p(share))


@compiled
def remove_point(posterior: GaussianInverseWishart, k: int, point: Floats) -> bool:
    """Take a point (dim,) out of category k.

    Returns:
        False if the category must be recomputed: it is empty, so the prior again, or too many digits cancelled.
    """
    before = posterior.mean_precision[k]
    change_count(posterior, k, -1.0)
    if posterior.counts[k] == 0.0:
        return False
    after = posterior.mean_precision[k]
    offset = np.empty(len(point))
    for j in range(len(point)):
        posterior.mean[k, j] = (before * posterior.mean[k, j] - point[j]) / after
        offset[j] = (after / before) ** 0.5 * (point[j] - posterior.mean[k, j])
    return downdate(posterior.upper[k], offset, _SMALLEST_SHARE)


@compiled
def add_point(posterior: GaussianInverseWishart, k: int, point: Floats) -> None:
    """Put a point (dim,) into category k."""
    before = posterior.mean_precision[k]
    change_count(posterior, k, 1.0)
    after = posterior.mean_precision[k]
    offset = np.empty(len(point))
    for j in range(len(point)):
        deviation = point[j] - posterior.mean[k, j]
        posterior.mean[k, j] += deviation / after
        offset[j] = (before / after) ** 0.5 * deviation
    update(posterior.upper[k], offset)


@compiled
def change_count(posterior: GaussianInverseWishart, k: int, change: float) -> None:
    """Add `change` to what category k counts: n, κ and ν."""
    posterior.counts[k] += change
    posterior.mean_precision[k] += change
    posterior.degrees_of_freedom[k] += change
