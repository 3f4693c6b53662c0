"""What a chain says of z and F: marginals of the words' channels, and a point estimate of each partition.

Labels of categories mean nothing from one state to the next, so that no category is averaged by its number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.data import Floats, Ints
from model.history import History, evenly
from model.problem import Problem

# Above so many elements the N × N co-assignments are left out.
LARGEST_TOGETHER = 1000
# Kept states whose expected variation is computed, and how many of the best of them a search starts from.
_CANDIDATES, _STARTS = 100, 4


@dataclass(frozen=True)
class Summary:
    """What the kept states of a chain have in common; tuples hold one array per channel x.

    Attributes:
        z: (N_x,) the partition with the least expected variation of information over the states; its categories are
            numbered in the order of their first elements.
        together: (N_x, N_x) share of the states in which two elements are in one category; None above
            `LARGEST_TOGETHER` elements.
        marginals: (T, sources) share of the states in which each channel, or ∅, explains a word; None without frames.
    """

    z: tuple[Ints, ...]
    together: tuple[Floats | None, ...]
    marginals: Floats | None

    @property
    def channels(self) -> Ints:
        """(T,) the most probable channel of each word, C for ∅, the first of equals; empty without frames."""
        if self.marginals is None:
            return np.empty(0, dtype=np.int64)
        return np.asarray(np.argmax(self.marginals, axis=1), dtype=np.int64)


def summarise(problem: Problem, kept: History) -> Summary:
    """Summarise the states of a chain that were kept after burn-in."""
    return Summary(
        z=tuple(point_estimate(z, prior.categories) for z, prior in zip(kept.z, problem.priors, strict=True)),
        together=tuple(co_assignments(z) for z in kept.z),
        marginals=word_marginals(problem, kept),
    )


def word_marginals(problem: Problem, kept: History) -> Floats | None:
    """(T, sources) the share of the states in which each channel, or ∅, explains a word; None without frames."""
    if not problem.method.has_frames:
        return None
    return np.stack([(kept.F == c).mean(axis=0) for c in range(problem.sources)], axis=1)


def co_assignments(z: Ints) -> Floats | None:
    """(N, N) the share of the states z (S, N) in which two elements share a category; None where N is too large."""
    if z.shape[1] > LARGEST_TOGETHER:
        return None
    return np.asarray(sum(np.equal.outer(state, state) for state in z) / len(z))


def point_estimate(z: Ints, K: int) -> Ints:
    """(N,) the partition with the least expected variation of information over the states z (S, N).

    The search is greedy and begins at the best of the states and at a single category, so that it ends nowhere worse.

    Args:
        z: Categories of each state.
        K: The most categories that the estimate may have; those of the states are below it.
    """
    from model.kernels.variation import descend, expected_variation

    named = np.stack([canonical(state) for state in z])
    states, K = np.ascontiguousarray(named.T), min(K, z.shape[1])
    different = np.unique(named[evenly(len(z), _CANDIDATES)], axis=0)
    expected = [expected_variation(states, one, K) for one in different]
    starts = [*different[np.argsort(expected, kind="stable")[:_STARTS]], np.zeros(z.shape[1], dtype=np.int64)]
    return min(
        (canonical(descend(states, start, K)) for start in starts),
        key=lambda found: float(expected_variation(states, found, K)),
    )


def canonical(z: Ints) -> Ints:
    """(N,) the same partition with categories numbered in the order of their first elements."""
    _, first, which = np.unique(z, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first, kind="stable"), kind="stable")[which].astype(np.int64)


def aligned(z: Ints, reference: Ints, K: int) -> Ints:
    """(N,) the same partition, categories renamed so that as many elements as possible have that of `reference`."""
    from scipy.optimize import linear_sum_assignment

    overlap = np.bincount(z * K + reference, minlength=K * K).reshape(K, K)
    return np.asarray(linear_sum_assignment(overlap, maximize=True)[1], dtype=np.int64)[z]
