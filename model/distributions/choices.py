"""Draws of one of several things, and of their order, for compiled code."""

from __future__ import annotations

import numpy as np

from model.compiled import lean
from model.data import Floats, Ints


@lean
def draw_weighted(rng: np.random.Generator, weights: Floats) -> int:
    """An index, with probability in proportion to weights, which need not be contiguous."""
    total = 0.0
    for weight in weights:
        total += weight
    threshold, chosen = rng.random() * total, 0
    for k in range(len(weights)):
        if weights[k] > 0.0:
            chosen = k
            threshold -= weights[k]
            if threshold < 0.0:
                break
    return chosen


@lean
def draw_other(rng: np.random.Generator, count: int, one: int) -> int:
    """Any of 0 to count − 1 but `one`, all alike."""
    other = int(rng.random() * (count - 1))
    return other + 1 if other >= one else other


@lean
def shuffle(rng: np.random.Generator, values: Ints) -> None:
    """Put values in random order."""
    for p in range(len(values) - 1, 0, -1):
        q = int(rng.random() * (p + 1))
        values[p], values[q] = values[q], values[p]
