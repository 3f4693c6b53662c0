"""Each kernel of the mixing sampler applied once to many states of a model small enough to enumerate."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import chain, product
from typing import Any

import numba
import numpy as np

from model import Prior, Problem
from model.data import Floats, Ints
from model.kernels.mixing.arrays import setup_of
from model.kernels.mixing.clusters import move_clusters
from model.kernels.mixing.counts import fill, log_masses
from model.kernels.mixing.exchange import exchange
from model.kernels.mixing.group_move import move_group
from model.kernels.mixing.permutation import permute_channels
from model.kernels.mixing.setup import Setup, tables_of
from model.kernels.mixing.silent import sweep_silent
from model.kernels.mixing.split_merge import split_or_merge
from model.kernels.mixing.trial_block import sweep_trials
from model.kernels.mixing.word_move import move_word
from model.state import Partition
from tests.model.samplers import tiny_trials

CATEGORIES = 3
PRIORS = (
    Prior(categories=CATEGORIES, mean_precision=0.5, scale=0.5, extra_degrees_of_freedom=3.0, word_concentration=0.3),
) * 2
# Objects and words per trial.
SHAPES = {
    "usual": ([2, 1, 1], [2, 1, 2]),
    "long sentence": ([1, 1], [8, 1]),
    "many objects": ([6], [1]),
    "word said twice": ([1, 1], [3, 2]),
}
# What a step does, with a number drawn uniformly from [0, 1) to choose a channel or a word by.
Step = Callable[[np.random.Generator, Any, Any, float], None]


@numba.njit
def _silent(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    sweep_silent(rng, setup, tables)


@numba.njit
def _trials(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    sweep_trials(rng, setup, tables)


@numba.njit
def _split_merge(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    split_or_merge(rng, setup, tables, int(u * len(setup.size)))


@numba.njit
def _group(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    move_group(rng, setup, tables, int(u * len(setup.size)))


@numba.njit
def _clusters(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    move_clusters(rng, setup, tables, int(u * len(setup.size)))


@numba.njit
def _word(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    move_word(rng, setup, tables, int(u * tables.words.shape[2]))


@numba.njit
def _exchange(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    exchange(rng, setup, tables, int(u * tables.words.shape[2]))


@numba.njit
def _permute(rng, setup, tables, u):  # type: ignore[no-untyped-def]
    permute_channels(rng, setup, tables, int(u * (tables.words.shape[2] + 2)) - 2)


KERNELS: dict[str, Step] = {
    "silent": _silent,
    "trial block": _trials,
    "split and merge": _split_merge,
    "group move": _group,
    "clusters": _clusters,
    "word move": _word,
    "exchange": _exchange,
    "permutation": _permute,
}


@cache
def walker(step: Step) -> Callable[..., None]:
    """Compiled: one step from each state zs (R, C, N), Fs (R, T), which change in place."""

    @numba.njit
    def walk(rng, setup, tables, zs, Fs):  # type: ignore[no-untyped-def]
        for r in range(len(zs)):
            tables.z[:] = zs[r]
            tables.F[:] = Fs[r]
            fill(setup, tables)
            step(rng, setup, tables, rng.random())
            zs[r], Fs[r] = tables.z, tables.F

    return walk  # type: ignore[no-any-return]


@numba.njit
def _log_masses(setup, tables, zs, Fs):  # type: ignore[no-untyped-def]
    result = np.empty(len(zs))
    for r in range(len(zs)):
        tables.z[:] = zs[r]
        tables.F[:] = Fs[r]
        fill(setup, tables)
        result[r] = log_masses(setup, tables)
    return result


@dataclass(frozen=True)
class Tiny:
    """Every state of a tiny problem, and their probabilities.

    Attributes:
        problem: The problem.
        setup: As the kernels know it, with the power of the features' densities.
        zs: (S, C, N) the states.
        Fs: (S, T) their frames.
        p: (S,) their probabilities.
        kind: (S,) which states differ in the names of the categories only.
    """

    problem: Problem
    setup: Setup
    zs: Ints
    Fs: Ints
    p: Floats
    kind: Ints

    def tables(self) -> Any:
        """New tables, to be filled."""
        first = Partition(tuple(z[:size] for z, size in zip(self.zs[0], self.setup.size, strict=True)), self.Fs[0])
        return tables_of(self.setup, len(self.problem.trials.vocabulary), first)


@cache
def tiny(method: str, power: float, shape: str = "usual") -> Tiny:
    """A problem of a vocabulary of two words, see `SHAPES`."""
    problem = Problem.of(tiny_trials(*SHAPES[shape], W=2), method, PRIORS)
    setup = setup_of(problem)._replace(beta=power)
    frames = list(_frames(problem))
    sizes = setup.size.tolist()
    states = list(product(product(range(CATEGORIES), repeat=sum(sizes)), frames))
    zs = np.full((len(states), len(sizes), max(sizes)), -1, dtype=np.int64)
    labels = np.array([z for z, _ in states])
    for c, size in enumerate(sizes):
        first = sum(sizes[:c])
        zs[:, c, :size] = labels[:, first : first + size]
    Fs = np.array([F for _, F in states], dtype=np.int64).reshape(len(states), -1)
    whole = Tiny(problem, setup, zs, Fs, np.empty(0), np.empty(0, dtype=np.int64))
    log_p = _log_masses(setup, whole.tables(), zs, Fs) + _log_frames(problem, Fs)
    p = np.exp(log_p - log_p.max())
    return Tiny(problem, setup, zs, Fs, p / p.sum(), kinds(sizes, zs, Fs))


def kinds(sizes: list[int], zs: Ints, Fs: Ints) -> Ints:
    """(S,) a number of each state that does not depend on the names of the categories."""
    parts = [Fs]
    for c, size in enumerate(sizes):
        z = zs[:, c, :size]
        # The first element of its category names it.
        parts.append((z[:, :, None] == z[:, None, :]).argmax(axis=2))
    rows = np.concatenate(parts, axis=1)
    return np.asarray(rows @ (10 ** np.arange(rows.shape[1])), dtype=np.int64)


def _log_frames(problem: Problem, Fs: Ints) -> Floats:
    """(S,) log p(F), which the tables know only where they follow from it."""
    if not problem.frame_prior.has_frames:
        return np.zeros(len(Fs))
    different, which = np.unique(Fs, axis=0, return_inverse=True)
    return np.array([problem.frame_prior.log_probability(problem.trials, F) for F in different])[which.ravel()]


def _frames(problem: Problem) -> Iterator[tuple[int, ...]]:
    if not problem.frame_prior.has_frames:
        yield ()
        return
    per_sentence = [problem.frame_prior.allowed(2, int(n)).tolist() for n in problem.trials.sentence_lengths]
    for frames in product(*per_sentence):
        yield tuple(chain.from_iterable(frames))
