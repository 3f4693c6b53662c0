"""Triangular factors of positive definite matrices: V = Uᵀ U with U upper triangular, L = Uᵀ.

A row of U is a column of the Cholesky factor L. Its elements lie side by side, so that every inner loop here is a
multiple of one row added to another, which vectorises without reordering any sum.
"""

from __future__ import annotations

import numpy as np

from model.compiled import compiled
from model.data import Floats

# A pivot that loses more than this share of itself in a downdate has lost too many digits.
_SMALLEST_SHARE = 1e-6


@compiled
def factorise(matrix: Floats, floor: float) -> None:
    """Replace the upper triangle of a positive definite matrix V (dim, dim) by U.

    Args:
        matrix: V, of which only the upper triangle is read and written.
        floor: V minus floor · I is positive semi-definite, so that no pivot is smaller but by rounding.
    """
    dim = len(matrix)
    for j in range(dim):
        row = matrix[j]
        pivot = max(row[j], floor) ** 0.5
        row[j] = pivot
        for i in range(j + 1, dim):
            row[i] /= pivot
        for i in range(j + 1, dim):
            target, share = matrix[i, i:], row[i]
            source = row[i:]
            for m in range(dim - i):
                target[m] -= share * source[m]


@compiled
def update(upper: Floats, vector: Floats) -> None:
    """Change U to the factor of V + v vᵀ (rank one, O(dim²)); v (dim,) is used up."""
    dim = len(upper)
    for j in range(dim):
        row, rest = upper[j, j + 1 :], vector[j + 1 :]
        old = upper[j, j]
        new = (old * old + vector[j] * vector[j]) ** 0.5
        cosine, sine = old / new, vector[j] / new
        upper[j, j] = new
        for i in range(dim - j - 1):
            above = row[i]
            row[i] = cosine * above + sine * rest[i]
            rest[i] = cosine * rest[i] - sine * above


@compiled
def downdate(upper: Floats, vector: Floats) -> bool:
    """Change U to the factor of V − v vᵀ (rank one, O(dim²)); v (dim,) is used up.

    Returns:
        False if too many digits would cancel. U is then of no use, and must be recomputed.
    """
    dim = len(upper)
    for j in range(dim):
        row, rest = upper[j, j + 1 :], vector[j + 1 :]
        old = upper[j, j]
        square = (old - vector[j]) * (old + vector[j])
        if not square > _SMALLEST_SHARE * old * old:
            return False
        new = square**0.5
        # The hyperbolic rotation in its mixed form, whose rounding errors stay small.
        cosine, sine = new / old, vector[j] / old
        upper[j, j] = new
        for i in range(dim - j - 1):
            row[i] = (row[i] - sine * rest[i]) / cosine
            rest[i] = cosine * rest[i] - sine * row[i]
    return True


@compiled
def squared_length(upper: Floats, vector: Floats) -> float:
    """The number vᵀ V⁻¹ v, by forward substitution; v (dim,) is used up and becomes U⁻ᵀ v."""
    dim = len(upper)
    total = 0.0
    for j in range(dim):
        value = vector[j] / upper[j, j]
        vector[j] = value
        total += value * value
        row, rest = upper[j, j + 1 :], vector[j + 1 :]
        for i in range(dim - j - 1):
            rest[i] -= value * row[i]
    return total


@compiled
def half_log_determinant(triangle: Floats) -> float:
    """Half of log |V| from its factor (dim, dim), upper or lower."""
    total = 0.0
    for j in range(len(triangle)):
        total += np.log(triangle[j, j])
    return total
