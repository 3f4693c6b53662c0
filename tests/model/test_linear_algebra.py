"""Triangular factors against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from model.data import Floats
from model.distributions import triangular as algebra


@pytest.fixture(params=[1, 2, 5, 30])
def matrix(request: pytest.FixtureRequest) -> Floats:
    """A positive definite matrix, all of whose eigenvalues are above 0.1."""
    points = np.random.default_rng(request.param).normal(size=(request.param + 3, request.param))
    return np.asarray(points.T @ points + 0.1 * np.eye(request.param))


def factor_of(matrix: Floats) -> Floats:
    upper = np.triu(matrix)
    algebra.factorise(upper, 0.1)
    return upper


def test_factor(matrix: Floats) -> None:
    assert factor_of(matrix) == pytest.approx(np.linalg.cholesky(matrix).T)
    assert 2 * algebra.half_log_determinant(factor_of(matrix)) == pytest.approx(np.linalg.slogdet(matrix)[1])


def test_rounding_is_no_negative_pivot() -> None:
    """Three points 1e9 apart from zero on one line: their scatter swallows the 0.01 of the prior."""
    direction = np.array([[1e9, 3e9, 7e9]])
    upper = np.triu(direction.T @ direction + 0.01 * np.eye(3))
    algebra.factorise(upper, 0.01)
    assert np.all(np.isfinite(upper))
    assert np.diagonal(upper).min() >= 0.1


def test_covariance_times_precision_is_one(matrix: Floats) -> None:
    upper = factor_of(matrix)
    columns = np.eye(len(matrix))
    for column in columns:
        algebra.squared_length(upper, column)
    # Row i is now U⁻ᵀ e_i, so that the rows' products are the inverse of V.
    assert matrix @ (columns @ columns.T) == pytest.approx(np.eye(len(matrix)), abs=1e-9)


def test_squared_length(matrix: Floats) -> None:
    vector = np.random.default_rng(1).normal(size=len(matrix))
    expected = vector @ np.linalg.solve(matrix, vector)
    assert algebra.squared_length(factor_of(matrix), vector) == pytest.approx(expected)


def test_update_and_downdate(matrix: Floats) -> None:
    vector = np.random.default_rng(2).normal(size=len(matrix))
    upper = factor_of(matrix)
    algebra.update(upper, vector.copy())
    assert upper == pytest.approx(np.linalg.cholesky(matrix + np.outer(vector, vector)).T)
    assert algebra.downdate(upper, vector.copy(), 1e-6)
    assert upper == pytest.approx(factor_of(matrix), rel=1e-9, abs=1e-11)


def test_downdate_says_when_digits_cancel(matrix: Floats) -> None:
    vector = np.full(len(matrix), 1e6)
    upper = factor_of(matrix)
    algebra.update(upper, vector.copy())
    assert not algebra.downdate(upper, vector.copy(), 1e-6)
