"""States of which only the spoken part is given: the elements that no sentence speaks of follow by Gibbs sampling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from model.data import Channel, Floats, Ints
from model.problem import Problem
from model.state import Partition


@dataclass(frozen=True)
class Completion:
    """A chain over the silent elements, all others and F held.

    Attributes:
        state: The last state.
        trace_log_joint: (sweeps,) log p(X, w, z, F) after each sweep, comparable with that of a fit.
    """

    state: Partition
    trace_log_joint: Floats


def complete(
    rng: np.random.Generator, problem: Problem, spoken: Sequence[Ints], F: Ints, sweeps: int = 100
) -> Completion:
    """Sample the silent elements given the categories of the others and F, with κ0 where it is learned.

    A silent element starts in the category of the nearest element that is spoken of.

    Args:
        rng: All randomness.
        problem: Data, method and hyperparameters; what has been learned of κ0 makes no difference.
        spoken: For each channel (D,) the category of the element that each trial's sentence is about.
        F: (T,) the channel of each word; empty for a method without frames.
        sweeps: Draws of each silent element.
    """
    from model.joint import log_constant
    from model.kernels.mean_precision import draw_given_partition
    from model.kernels.mixing.arrays import relearn, setup_of
    from model.kernels.mixing.counts import fill, fill_channel, log_masses
    from model.kernels.mixing.setup import tables_of
    from model.kernels.mixing.silent import sweep_silent

    pairs = zip(problem.trials.channels, spoken, strict=True)
    state = Partition(tuple(_start(*pair) for pair in pairs), F)
    setup, trace = setup_of(problem), np.empty(sweeps)
    tables = tables_of(setup, len(problem.trials.vocabulary), state)
    fill(setup, tables)
    for i in range(sweeps):
        if problem.learns:
            problem = draw_given_partition(rng, problem, state, 1.0)
            for c in np.flatnonzero(relearn(setup, problem)).tolist():
                fill_channel(setup, tables, c)
        sweep_silent(rng, setup, tables)
        state = Partition(tuple(tables.z[c, :size].copy() for c, size in enumerate(setup.size)), F)
        trace[i] = log_constant(problem, state) + log_masses(setup, tables)
    return Completion(state, trace)


def _start(channel: Channel, spoken: Ints) -> Ints:
    """(N,) for each element the category (of those spoken of, (D,)) of the nearest speaker, of a speaker its own."""
    nearest = cdist(channel.features, channel.features[channel.speaker]).argmin(axis=1)
    z = np.ascontiguousarray(spoken[nearest])
    z[channel.speaker] = spoken
    return z
