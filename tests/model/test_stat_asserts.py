"""The statistical assertions accept what is right and refuse what is not."""

from __future__ import annotations

import numpy as np
import pytest

from model.data import Floats
from tests.model import stat_asserts


def autoregressive(correlation: float, draws: int = 4000, chains: int = 2) -> Floats:
    """Chains of a stationary standard normal with the given lag-one correlation."""
    rng = np.random.default_rng(6)
    noise: Floats = rng.normal(size=(chains, draws, 1)) * np.sqrt(1 - correlation**2)
    noise[:, 0] /= np.sqrt(1 - correlation**2)
    for t in range(1, draws):
        noise[:, t] += correlation * noise[:, t - 1]
    return noise


def test_effective_size_is_that_of_an_autoregressive_chain() -> None:
    expected = 8000 * (1 - 0.8) / (1 + 0.8)
    assert stat_asserts.effective_size(autoregressive(0.8))[0] == pytest.approx(expected, rel=0.15)
    assert stat_asserts.effective_size(np.ones((2, 50, 1)))[0] == np.inf


def test_the_right_mean_is_accepted_and_a_wrong_one_is_not() -> None:
    draws = autoregressive(0.8)
    stat_asserts.assert_means(draws, np.zeros(1))
    with pytest.raises(AssertionError, match="standard errors off"):
        stat_asserts.assert_means(draws, np.array([0.2]))
    # What is significant for independent draws is not for correlated ones.
    with pytest.raises(AssertionError, match="standard errors off"):
        stat_asserts.assert_means(np.random.default_rng(1).normal(size=(2, 4000, 1)), np.array([0.08]))
    stat_asserts.assert_means(draws, np.array([0.08]))


def test_a_wrong_constant_is_refused() -> None:
    with pytest.raises(AssertionError, match="standard errors off"):
        stat_asserts.assert_means(np.ones((2, 500, 1)), np.array([0.9]))


def test_a_chain_that_hardly_moves_proves_nothing() -> None:
    with pytest.raises(pytest.fail.Exception, match="effective sample size"):
        stat_asserts.assert_means(autoregressive(0.999), np.zeros(1))


def test_independent_draws_bring_their_own_error() -> None:
    rng = np.random.default_rng(2)
    stat_asserts.assert_same_distribution(autoregressive(0.5), rng.normal(size=(3000, 1)))
    with pytest.raises(AssertionError, match="standard errors off"):
        stat_asserts.assert_same_distribution(autoregressive(0.5), rng.normal(size=(3000, 1)) + 0.3)


def test_ranks() -> None:
    rng = np.random.default_rng(3)
    assert stat_asserts.uniform_p_value(rng.integers(64, size=400), 63) > 1e-3
    assert stat_asserts.uniform_p_value(rng.integers(50, size=400), 63) < 1e-6
