"""The partition with the least expected variation of information (VI) over the states of a chain.

Of two partitions of N elements with categories of n_a and m_b elements, t_ab of them common to both (Meilă 2007),

    N · VI = Σ_a n_a ln n_a + Σ_b m_b ln m_b − 2 Σ_ab t_ab ln t_ab.

Its mean over S states needs the S tables t alone, so that memory grows with N and not with N². So the mean itself is
minimised (Wade and Ghahramani 2018), not the lower bound that they take from the N × N co-assignments. The search is
greedy, as in Dahl, Johnson and Müller (2022): single elements move and categories merge while that lowers the mean.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints

# In units of N · S · VI: less is rounding. Each change lowers the sum by more, so that the search ends.
_GAIN = 1e-6


@compiled
def _overlaps(states: Ints, z: Ints, K: int) -> Ints:
    """(K, S, K_S) how many elements of each category of `z` are in each category of each state (N, S)."""
    N, S = states.shape
    tables = np.zeros((K, S, states.max() + 1), dtype=np.int64)
    for i in range(N):
        for s in range(S):
            tables[z[i], s, states[i, s]] += 1
    return tables


@compiled
def _n_log_n(most: int) -> Floats:
    """(most + 1,) n ln n."""
    result = np.zeros(most + 1)
    for n in range(2, most + 1):
        result[n] = n * math.log(n)
    return result


@compiled
def expected_variation(states: Ints, z: Ints, K: int) -> float:
    """The mean variation of information, in nats, of categories z (N,), below K, and states (N, S)."""
    N, S = states.shape
    f, tables = _n_log_n(N), _overlaps(states, z, K)
    total = 0.0
    for s in range(S):
        for k in range(tables.shape[2]):
            size = 0
            for a in range(K):
                size += tables[a, s, k]
                total -= 2.0 * f[tables[a, s, k]]
            total += f[size]
    for a in range(K):
        total += S * f[tables[a, 0].sum()]
    return float(total / (N * S))


@compiled
def descend(states: Ints, start: Ints, K: int) -> Ints:
    """(N,) at most K categories from which no move of an element and no merger lowers the expected variation.

    Args:
        states: (N, S) categories of the states, best numbered without gaps: tables grow with the largest number.
        start: (N,) where the search begins, below K.
        K: The most categories.
    """
    z = start.copy()
    f, tables = _n_log_n(len(z)), _overlaps(states, z, K)
    sizes = np.bincount(z, minlength=K)
    changed = True
    while changed:
        changed = False
        for i in range(len(z)):
            b = _best_category(f, states[i], z[i], tables, sizes)
            if b != z[i]:
                for s in range(states.shape[1]):
                    tables[z[i], s, states[i, s]] -= 1
                    tables[b, s, states[i, s]] += 1
                sizes[z[i]] -= 1
                sizes[b] += 1
                z[i] = b
                changed = True
        for a in range(K):
            for b in range(a + 1, K):
                if sizes[a] > 0 and sizes[b] > 0 and _change_by_merger(f, a, b, tables, sizes) < -_GAIN:
                    tables[a] += tables[b]
                    tables[b] = 0
                    sizes[a] += sizes[b]
                    sizes[b] = 0
                    z[z == b] = a
                    changed = True
    return z


@compiled
def _best_category(f: Floats, own: Ints, a: int, tables: Ints, sizes: Ints) -> int:
    """The category to which an element of category `a`, in categories `own` (S,) of the states, had better go."""
    S = len(own)
    leave = S * (f[sizes[a] - 1] - f[sizes[a]])
    for s in range(S):
        t = tables[a, s, own[s]]
        leave -= 2.0 * (f[t - 1] - f[t])
    best, least, opened = a, -_GAIN, sizes[a] == 1  # one that is alone needs no other empty category
    for b in range(len(sizes)):
        if b == a or (sizes[b] == 0 and opened):
            continue
        opened = opened or sizes[b] == 0
        change = leave + S * (f[sizes[b] + 1] - f[sizes[b]])
        for s in range(S):
            t = tables[b, s, own[s]]
            change -= 2.0 * (f[t + 1] - f[t])
        if change < least:
            best, least = b, change
    return best


@compiled
def _change_by_merger(f: Floats, a: int, b: int, tables: Ints, sizes: Ints) -> float:
    """What a merger of two categories adds to N · S times the expected variation."""
    _, S, labels = tables.shape
    change = S * (f[sizes[a] + sizes[b]] - f[sizes[a]] - f[sizes[b]])
    for s in range(S):
        for k in range(labels):
            left, right = tables[a, s, k], tables[b, s, k]
            change -= 2.0 * (f[left + right] - f[left] - f[right])
    return float(change)
