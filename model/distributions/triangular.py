"""Triangular factors of positive definite matrices: V = Uᵀ U with U upper triangular, L = Uᵀ.

A row of U is a column of the Cholesky factor L. Its elements lie side by side, so that every inner loop here is a
multiple of one row added to another, which vectorises without reordering any sum.
"""

from __future__ import annotations

import numpy as np

from model.compiled import compiled, inlined, lean
from model.data import Floats


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


@lean
def update(upper: Floats, vector: Floats) -> None:
    """Change U to the factor of V + v vᵀ (rank one, O(dim²)); v (dim,) is used up. U may be padded to more rows."""
    dim = len(vector)
    for j in range(dim):
        row = upper[j]
        old = row[j]
        new = (old * old + vector[j] * vector[j]) ** 0.5
        cosine, sine = old / new, vector[j] / new
        row[j] = new
        for i in range(j + 1, dim):
            above = row[i]
            row[i] = cosine * above + sine * vector[i]
            vector[i] = cosine * vector[i] - sine * above


@lean
def downdate(upper: Floats, vector: Floats, least: float) -> bool:
    """Change U to the factor of V − v vᵀ (rank one, O(dim²)); v (dim,) is used up. U may be padded to more rows.

    Returns:
        False if a pivot would keep no more than the share `least` of itself, so that too many digits would cancel. U
        is then of no use, and must be recomputed.
    """
    dim = len(vector)
    for j in range(dim):
        row = upper[j]
        old = row[j]
        square = (old - vector[j]) * (old + vector[j])
        if not square > least * old * old:
            return False
        new = square**0.5
        # The hyperbolic rotation in its mixed form, whose rounding errors stay small.
        cosine, sine = new / old, vector[j] / old
        row[j] = new
        for i in range(j + 1, dim):
            row[i] = (row[i] - sine * vector[i]) / cosine
            vector[i] = cosine * vector[i] - sine * row[i]
    return True


@compiled
def squared_length(upper: Floats, vector: Floats) -> float:
    """The number vᵀ V⁻¹ v; v (dim,) is used up and becomes U⁻ᵀ v."""
    return solve(upper, vector, 0, len(vector))


@inlined
def solve(upper: Floats, vector: Floats, first: int, size: int) -> float:
    """Let y = U⁻ᵀ v replace v, whose numbers before `first` are 0, by forward substitution; returns |y|²."""
    total = 0.0
    for j in range(first, size):
        row = upper[j]
        value = vector[j] / row[j]
        vector[j] = value
        total += value * value
        for i in range(j + 1, size):
            vector[i] -= value * row[i]
    return total


@compiled
def half_log_determinant(triangle: Floats) -> float:
    """Half of log |V| from its factor (dim, dim), upper or lower."""
    total = 0.0
    for j in range(len(triangle)):
        total += np.log(triangle[j, j])
    return total
