"""Dirichlet and categorical distributions, in log space."""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints


@compiled
def log_total(values: Floats) -> float:
    """Log Σ exp of (K,) values: `log_space.log_sum` for compiled code."""
    top = values.max()
    if top == -np.inf:
        return -np.inf
    total = 0.0
    for value in values:
        total += math.exp(value - top)
    return float(top + math.log(total))


@compiled
def draw_log_dirichlet(rng: np.random.Generator, concentration: Floats, averaged_draws: int) -> Floats:
    """Logarithms of Dirichlet draws, one for each row of (rows, size) concentrations.

    Small concentrations underflow as probabilities, so log-Gamma variates are drawn, by
    Gamma(a) = Gamma(a + 1) · U^(1/a).

    Args:
        rng: The fit's generator.
        concentration: Positive, (rows, size).
        averaged_draws: The result is the log of the mean of this many draws (docs/model.md, The samplers).
    """
    rows, size = concentration.shape
    result = np.empty((rows, size))
    if size == 0:  # An empty vocabulary.
        return result
    draw = np.empty(size)
    for r in range(rows):
        for repeat in range(averaged_draws):
            for i in range(size):
                a = concentration[r, i]
                draw[i] = math.log(rng.standard_gamma(a + 1.0)) - rng.standard_exponential() / a
            total = log_total(draw)
            for i in range(size):
                log_probability = draw[i] - total
                if repeat > 0:
                    high, low = max(result[r, i], log_probability), min(result[r, i], log_probability)
                    log_probability = high + math.log1p(math.exp(low - high))
                result[r, i] = log_probability
        if averaged_draws > 1:
            result[r] -= math.log(averaged_draws)
    return result


@compiled
def dirichlet_log_density(log_probabilities: Floats, concentration: Floats) -> float:
    """Sum over the rows of the log density of Dirichlet draws given as logarithms, all (rows, size)."""
    rows, size = concentration.shape
    total = 0.0
    if size == 0:
        return total
    for r in range(rows):
        total += math.lgamma(concentration[r].sum())
        for i in range(size):
            total += (concentration[r, i] - 1.0) * log_probabilities[r, i] - math.lgamma(concentration[r, i])
    return total


@compiled
def draw_index(rng: np.random.Generator, log_weights: Floats) -> int:
    """One index of (K,) unnormalised log weights, by the inverse of the cumulative sum."""
    top = log_weights.max()
    total = 0.0
    for value in log_weights:
        total += math.exp(value - top)
    threshold = rng.random() * total
    chosen, cumulative = 0, 0.0
    for k in range(len(log_weights)):
        weight = math.exp(log_weights[k] - top)
        if weight > 0.0:
            chosen = k  # The last one that is possible, should rounding leave the threshold above the sum.
            cumulative += weight
            if cumulative > threshold:
                break
    return chosen


@compiled
def draw_categorical(rng: np.random.Generator, log_weights: Floats) -> Ints:
    """One index per row of (N, K) unnormalised log weights."""
    result = np.empty(len(log_weights), dtype=np.int64)
    for i in range(len(log_weights)):
        result[i] = draw_index(rng, log_weights[i])
    return result


@compiled
def count_log_marginal(counts: Floats, concentration: float) -> float:
    """Log probability of draws counted in (rows, size), one symmetric Dirichlet per row integrated out."""
    rows, size = counts.shape
    total = 0.0
    for r in range(rows):
        row_total = counts[r].sum()
        if row_total > 0.0:
            total += math.lgamma(size * concentration) - math.lgamma(size * concentration + row_total)
            for count in counts[r]:
                if count > 0.0:
                    total += math.lgamma(count + concentration) - math.lgamma(concentration)
    return total
