"""The mixing sampler: kernels that merge, split and exchange what one-element Gibbs sampling cannot."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from model.data import Ints
from model.samplers.base import Iterations, Kept, Marginal, Temperature
from model.state import Partition

if TYPE_CHECKING:
    from model.kernels.mixing.setup import Setup, Tables
    from model.problem import Problem

# Tables are computed anew after so many sweeps, so that rounding errors cannot add up.
_REFILLED_AFTER = 50
# Elements of a channel up to which all moves of a sweep are tried: a move's cost grows with the categories, so that
# beyond it their number falls, and a sweep's cost grows as the number of elements.
_FEW = 100
# How many moves of elements a sweep may have, and of words.
OfChannels = Annotated[int, Field(ge=0, le=100_000)]
OfWords = Annotated[int, Field(ge=0, le=1000)]


@dataclass(frozen=True)
class Followed(Partition):
    """A state whose tables the next step takes over and changes, so that it can be continued once.

    Attributes:
        problem: What the tables were made for.
        setup: The problem as the kernels know it.
        tables: What follows from z and F.
    """

    problem: Problem
    setup: Setup
    tables: Tables


class Mixing(Marginal):
    """Sweeps of several kernels over z and F, π, φ and θ integrated out; ends with their posterior means.

    The kernels are `model.kernels.mixing`; docs/model.md, The samplers, says what each is for.
    """

    annealing = 0.3  # well within the iterations that are left out as burn-in
    kind: Literal["mixing"] = "mixing"
    iterations: Iterations = Field(default=600, description="sweeps per chain")
    keep_history: Kept = Field(
        default=300,
        description="number of states whose z and F are kept, evenly spaced up to the last; at most all",
    )
    parameters: Literal["draw", "mean", "average"] = Field(
        default="mean", description="as for the other kinds; the default is the summary, which one state is not"
    )
    temperature: Temperature = Field(
        default=3.0,
        description="the power to which the densities of the features are raised rises from 1/temperature to 1 over "
        "the first three tenths of the iterations; 1 is no annealing",
    )
    trial_sweeps: int = Field(
        default=2, ge=1, le=1000, description="draws of each trial's frame and categories per sweep"
    )
    split_merge: OfChannels = Field(
        default=20, description="splits, merges and shuffles of categories per sweep, of all channels"
    )
    group_moves: OfChannels = Field(
        default=20, description="moves of an element, and of those that follow it, per sweep, of all channels"
    )
    cluster_moves: OfChannels = Field(
        default=300,
        description="draws of the categories of up to three clusters of elements per sweep, of all channels",
    )
    word_moves: OfWords = Field(default=2, description="moves of a word to another channel per sweep")
    exchanges: OfWords = Field(default=2, description="exchanges of two channels' words per sweep")
    permutations: OfWords = Field(default=4, description="permutations of all channels' words per sweep")

    def step(self, rng: np.random.Generator, problem: Problem, state: Partition, iteration: int) -> Followed:
        """Apply the kernels, in the numbers that the settings say."""
        from model.kernels.mixing.sweep import Recipe, sweep

        followed = _follow(problem, state, iteration % _REFILLED_AFTER == 0)
        setup, tables = followed.setup, followed.tables
        recipe = Recipe(
            silent=1,
            trials=self.trial_sweeps,
            split_merge=_shared(self.split_merge, setup),
            group_moves=_shared(self.group_moves, setup),
            cluster_moves=_shared(self.cluster_moves, setup),
            word_moves=self.word_moves,
            exchanges=self.exchanges,
            permutations=self.permutations,
        )
        sweep(rng, setup._replace(beta=self.power(iteration)), tables, recipe)
        z = tuple(tables.z[c, :N].copy() for c, N in enumerate(setup.size))
        return Followed(z, tables.F.copy(), problem, setup, tables)

    def log_joint(self, problem: Problem, state: Partition) -> float:
        """Log p(X, w, z, F) from the tables."""
        from model.joint import log_constant
        from model.kernels.mixing.counts import log_masses

        followed = _follow(problem, state, False)
        return log_constant(problem, state) + log_masses(followed.setup, followed.tables)

    def power(self, iteration: int) -> float:
        """The power to which the densities of the features are raised, which rises to 1 while chains are annealed."""
        done = iteration / (self.annealing * self.iterations)
        return 1.0 if done >= 1.0 else (1.0 + (self.temperature - 1.0) * done) / self.temperature


def _follow(problem: Problem, state: Partition, anew: bool) -> Followed:
    """The state with its tables: those it has for this problem, or computed if it has none, or if they are to be."""
    from model.kernels.mixing.arrays import relearn, setup_of
    from model.kernels.mixing.counts import fill, fill_channel
    from model.kernels.mixing.setup import tables_of

    if not isinstance(state, Followed) or not state.problem.is_like(problem):
        setup = setup_of(problem)
        tables = tables_of(setup, len(problem.trials.vocabulary), state)
        fill(setup, tables)
        return Followed(state.z, state.F, problem, setup, tables)
    if state.problem is problem and not anew:
        return state
    changed = relearn(state.setup, problem)
    for c in range(len(changed)):
        if changed[c] or anew:
            fill_channel(state.setup, state.tables, c)
    return replace(state, problem=problem)


def _shared(moves: int, setup: Setup) -> Ints:
    """(C,) how many of the moves each channel gets.

    In proportion to its dimensions, since what makes a category hard to open or to close grows with them; but two in
    five at least of what a channel would get if all were alike.
    """
    share = np.maximum(setup.dim / setup.dim.sum(), 0.4 / len(setup.dim)) * np.minimum(1.0, _FEW / setup.size)
    return np.array([math.ceil(moves * part) for part in share], dtype=np.int64)
