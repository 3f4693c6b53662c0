"""Sums of probabilities given as logarithms: along an axis, and over the subsets of a sentence's words.

Subset s of N words holds word n where bit n of s is set.
"""

from __future__ import annotations

import numpy as np

from model.data import Floats, Ints


def log_sum(values: Floats) -> Floats:
    """Log Σ exp along the last axis, which is kept, of an array of any shape; −inf where all values are."""
    top = np.max(values, axis=-1, keepdims=True)
    finite = np.where(np.isneginf(top), 0.0, top)
    with np.errstate(divide="ignore"):
        return np.asarray(finite + np.log(np.sum(np.exp(values - finite), axis=-1, keepdims=True)))


def subset_sizes(subsets: int) -> Ints:
    """(2^N,) the number of words in each subset."""
    return np.array([s.bit_count() for s in range(subsets)], dtype=np.int64)


def subset_log_products(log_words: Floats) -> Floats:
    """(K, 2^N) log ∏_{n ∈ S} θ_{k, w_n} of each subset S, from (K, N) log θ_{k, w_n}."""
    result = np.zeros((len(log_words), 1))
    for n in range(log_words.shape[1]):
        result = np.concatenate([result, result + log_words[:, n : n + 1]], axis=1)
    return result


def convolve_subsets(left: Floats, right: Floats) -> Floats:
    """(M, 2^N) log Σ_{S ⊆ T} exp(left[S] + right[T ∖ S]) of each subset T."""
    count = left.shape[1]
    every = np.arange(count)
    result = np.full_like(left, -np.inf)
    for s in range(count):
        if np.all(np.isneginf(right[:, s])):
            continue
        apart = every[every & s == 0]
        result[:, apart | s] = np.logaddexp(result[:, apart | s], left[:, apart] + right[:, s : s + 1])
    return result
