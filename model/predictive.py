"""Gaussian categories while points come and go: rank-one changes, and the predictive Student distribution."""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats
from model.gaussians import GaussianInverseWishart
from model.linear_algebra import downdate, half_log_determinant, squared_length, update

_LOG_PI = math.log(math.pi)


@compiled
def student_constant(law: GaussianInverseWishart, k: int) -> float:
    """Log of the constant of the predictive density of category k.

    t_{ν−dim+1}(x | m, V (κ+1) / (κ (ν−dim+1))) = exp(constant) · (1 + κ/(κ+1) · q)^(−(ν+1)/2), q = (x−m)ᵀ V⁻¹ (x−m).
    """
    dim = law.mean.shape[1]
    nu, kappa = law.freedom[k], law.strength[k]
    gammas = math.lgamma(0.5 * (nu + 1.0)) - math.lgamma(0.5 * (nu + 1.0 - dim))
    power = 0.5 * dim * (math.log(kappa / (kappa + 1.0)) - _LOG_PI)
    return float(gammas + power - half_log_determinant(law.upper[k]))


@compiled
def student_log_density(law: GaussianInverseWishart, k: int, constant: float, point: Floats, offset: Floats) -> float:
    """Log predictive density of a point (dim,) under category k, see `student_constant`.

    `offset` (dim,) is working space.
    """
    for j in range(len(point)):
        offset[j] = point[j] - law.mean[k, j]
    kappa = law.strength[k]
    share = kappa / (kappa + 1.0) * squared_length(law.upper[k], offset)
    return float(constant - 0.5 * (law.freedom[k] + 1.0) * math.log1p(share))


@compiled
def remove_point(law: GaussianInverseWishart, k: int, point: Floats) -> bool:
    """Take a point (dim,) out of category k.

    Returns:
        False if the category is to be computed anew: it is empty, and the prior again, or too many digits cancelled.
    """
    before = law.strength[k]
    change_count(law, k, -1.0)
    if law.counts[k] == 0.0:
        return False
    after = law.strength[k]
    offset = np.empty(len(point))
    for j in range(len(point)):
        law.mean[k, j] = (before * law.mean[k, j] - point[j]) / after
        offset[j] = (after / before) ** 0.5 * (point[j] - law.mean[k, j])
    return downdate(law.upper[k], offset)


@compiled
def add_point(law: GaussianInverseWishart, k: int, point: Floats) -> None:
    """Put a point (dim,) into category k."""
    before = law.strength[k]
    change_count(law, k, 1.0)
    after = law.strength[k]
    offset = np.empty(len(point))
    for j in range(len(point)):
        deviation = point[j] - law.mean[k, j]
        law.mean[k, j] += deviation / after
        offset[j] = (before / after) ** 0.5 * deviation
    update(law.upper[k], offset)


@compiled
def change_count(law: GaussianInverseWishart, k: int, change: float) -> None:
    """Add `change` to what category k counts: n, κ and ν."""
    law.counts[k] += change
    law.strength[k] += change
    law.freedom[k] += change
