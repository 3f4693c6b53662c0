"""Statistical assertions, scaled by Monte Carlo error and gated by effective sample size."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from model.data import Floats

# A right sampler is this many standard errors off with a probability of 1e-5, times the number of quantities.
LIMIT = 4.5
SMALLEST_SIZE = 100.0


def effective_size(draws: Floats) -> Floats:
    """(Q,) effective sample sizes of the means of (chains, draws, Q); infinite where a quantity is constant."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # ArviZ announces its next version.
        import arviz
    sizes = [float(arviz.ess(draws[:, :, q], method="mean")) for q in range(draws.shape[2])]  # type: ignore[no-untyped-call]
    constant = np.ptp(draws, axis=(0, 1)) == 0
    return np.where(constant, np.inf, sizes)


def standard_error(draws: Floats) -> Floats:
    """(Q,) Monte Carlo errors of the means of (chains, draws, Q)."""
    return np.asarray(draws.std(axis=(0, 1)) / np.sqrt(effective_size(draws)))


def distances(draws: Floats, expected: Floats, error: Floats | float = 0.0, floor: float = 1e-3) -> Floats:
    """(Q,) how far the means of (chains, draws, Q) are from `expected`, in standard errors.

    Args:
        draws: Of a Markov chain or of several.
        expected: (Q,).
        error: Standard error of `expected`.
        floor: The smallest standard error, in standard deviations of a quantity, and for a constant one as such.
    """
    if draws.ndim != 3:
        raise ValueError(f"draws are {draws.shape}, not (chains, draws, quantities)")
    sizes = effective_size(draws)
    if sizes.min() < SMALLEST_SIZE:
        worst = int(sizes.argmin())
        pytest.fail(f"quantity {worst} has an effective sample size of {sizes[worst]:.0f}: nothing can be said")
    spread = draws.std(axis=(0, 1))
    scale = np.maximum(np.hypot(standard_error(draws), error), floor * np.where(spread > 0, spread, 1.0))
    return np.asarray(np.abs(draws.mean(axis=(0, 1)) - expected) / scale)


def assert_means(draws: Floats, expected: Floats, error: Floats | float = 0.0) -> None:
    """The means of (chains, draws, Q) are the expected ones within Monte Carlo error."""
    off = distances(draws, expected, error)
    worst = int(off.argmax())
    assert off[worst] < LIMIT, (
        f"quantity {worst} of {len(off)} is {off[worst]:.1f} standard errors off: "
        f"{draws.mean(axis=(0, 1))[worst]:.4f}, expected {expected[worst]:.4f}"
    )


def assert_same_distribution(draws: Floats, independent: Floats) -> None:
    """The means of a chain (chains, draws, Q) are those of independent draws (n, Q)."""
    error = independent.std(axis=0) / np.sqrt(len(independent))
    assert_means(draws, independent.mean(axis=0), error)


def uniform_p_value(ranks: np.ndarray, largest: int, bins: int = 8) -> float:
    """The χ² p-value of ranks 0..largest being uniform; largest + 1 is a multiple of the number of bins."""
    from scipy import stats

    counts = np.bincount(np.asarray(ranks, dtype=np.int64) * bins // (largest + 1), minlength=bins)
    return float(stats.chisquare(counts).pvalue)
