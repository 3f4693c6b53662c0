"""What is kept of chains beside their last state."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from model.data import Floats, Ints
from model.problem import Problem
from model.state import Partition


def burned(burn_in: float, iterations: int) -> int:
    """How many iterations at the start of a chain are left out, given their share."""
    return int(burn_in * iterations)


def evenly(count: int, most: int) -> list[int]:
    """At most `most` of the indices 0 to count − 1, evenly spaced up to the last."""
    chosen = min(count, most)
    return [h * count // chosen - 1 for h in range(1, chosen + 1)]


@dataclass(frozen=True)
class History:
    """Earlier states of a chain.

    Attributes:
        iterations: (H,) after which iteration, counted from 1.
        z: (H, N_x) z^x of each state, one array per channel.
        F: (H, T), or (H, 0) for a method without frames.
        mean_precision: (H, C) κ0 of each channel where any learns it, else None.
    """

    iterations: Ints
    z: tuple[Ints, ...]
    F: Ints
    mean_precision: Floats | None = None

    @classmethod
    def of(cls, iterations: Ints, states: Sequence[Partition], trace: Floats | None = None) -> History:
        """Gather states, and of a trace (iterations, C) of κ0 the values that belong to them."""
        z = tuple(np.stack(parts) for parts in zip(*(state.z for state in states), strict=True))
        F = np.stack([state.F for state in states])
        return cls(iterations, z, F, None if trace is None else trace[iterations - 1])

    def after(self, skipped: int) -> History | None:
        """The states after the first `skipped` iterations; None if there are none."""
        kept = np.flatnonzero(self.iterations > skipped)
        return self._chosen(kept) if len(kept) else None

    def thinned(self, most: int) -> History:
        """At most so many of the states, evenly spaced up to the last."""
        return self._chosen(np.array(evenly(len(self.iterations), most), dtype=np.int64))

    def states(self, problem: Problem) -> Iterator[tuple[Problem, Partition]]:
        """Each state, and before it the problem with its κ0."""
        for h in range(len(self.iterations)):
            given = problem if self.mean_precision is None else problem.given(self.mean_precision[h])
            yield given, Partition(tuple(part[h] for part in self.z), self.F[h])

    def typical(self, problem: Problem) -> Problem:
        """The problem with the geometric mean of the states' κ0."""
        if self.mean_precision is None:
            return problem
        return problem.given(np.exp(np.log(self.mean_precision).mean(axis=0)))

    def _chosen(self, rows: Ints) -> History:
        kappa = None if self.mean_precision is None else self.mean_precision[rows]
        return History(self.iterations[rows], tuple(part[rows] for part in self.z), self.F[rows], kappa)


@dataclass(frozen=True)
class Chains:
    """What all chains of a fit went through, the kept one among them, so that they can be compared.

    Attributes:
        log_joint: (chains, iterations) log p(X, w, z, F) after each iteration.
        used: (chains, iterations, C) number of categories in use, after each iteration.
        marginals: (chains, T, sources) for each word the share of a chain's kept states after burn-in in which a
            channel, or ∅, explains it; None for a method without frames, and where no states were kept.
    """

    log_joint: Floats
    used: Ints
    marginals: Floats | None
