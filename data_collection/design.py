"""What the trials of a test set are to be about: a sequence in which every word takes its turn.

The sequence depends on the seed and the names of the set alone, not on the size of the set: a set of n trials is its
first n targets, so that a larger set keeps the trials of a smaller one. It is fair however far it is followed: each
word of each channel is due equally often, ± 1. Position, object and color are as independent as counts allow, and the
action of them as far as that leaves open.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from data_collection.apparatus import ObjectKind
from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation

Ints = NDArray[np.int64]

_LEAST, _MOST = 36, 2520
"""Targets that are laid out together, in a multiple of each channel's number of words where that is not too many."""
_SEQUENCES, _OPTIONS = 64, 20_000
"""Sequences that are followed at the same time, and at most so many of their continuations are compared."""
_TABLES: Mapping[tuple[int, ...], int] = {
    (0, 1): 1,
    (0, 2): 1,
    (0, 3): 1,
    (1, 2): 3,
    (1, 3): 3,
    (2, 3): 3,
    (1, 2, 3): 1,
}
"""The channels (action, position, object, color) whose words are to meet equally often, and how much that weighs."""


@dataclass(frozen=True)
class Target:
    """What a trial of a test set is about.

    Attributes:
        action: Which of the four actions, a key of `Simulation.actions`.
        place: Word of the place of the attended object.
        kind: The attended object.
    """

    action: str
    place: str
    kind: ObjectKind


def target(simulation: Simulation, *, experiment: str, set_name: str, trial: int, seed: int) -> Target:
    """Return what a trial is about.

    Where words of objects and colors cannot all be due equally often, since too few objects have them, those that are
    behind come first.

    Args:
        simulation: Settings of the experiment.
        experiment: Its name.
        set_name: Name of the test set.
        trial: Number of the trial, from 1.
        seed: Seed of the study.
    """
    kinds = simulation.kinds()
    pairs = sorted({(kind.object, kind.color) for kind in kinds})
    names = (seed, experiment, set_name)
    actions, places = tuple(simulation.actions), tuple(simulation.places)
    block, row = divmod(trial - 1, block_size(actions, places, pairs))
    laid_out = _block(actions, places, tuple(pairs), names, block)
    action, place, pair = laid_out[row]
    # Objects that are called the same take turns.
    same = [kind for kind in kinds if (kind.object, kind.color) == pair]
    before = sum(other == pair for *_, other in laid_out[:row])
    order = generator(seed, "design", experiment, set_name, block, *pair).permutation(len(same))
    return Target(action, place, same[int(order[before % len(same)])])


def block_size(actions: Sequence[str], places: Sequence[str], pairs: Sequence[tuple[str, str]]) -> int:
    """Return after how many targets another part of the sequence begins, drawn by itself.

    Args:
        actions: The actions.
        places: The words of places.
        pairs: The words of object and color that some object has.
    """
    objects, colors = ({pair[i] for pair in pairs} for i in (0, 1))
    round_of_all = math.lcm(*map(len, (actions, places, objects, colors)))
    return min(math.ceil(_LEAST / round_of_all) * round_of_all, _MOST)


@lru_cache(maxsize=16)
def _block(
    actions: tuple[str, ...],
    places: tuple[str, ...],
    pairs: tuple[tuple[str, str], ...],
    names: tuple[int, str, str],
    block: int,
) -> tuple[tuple[str, str, tuple[str, str]], ...]:
    """Return a part of the sequence: action, place and pair of each target."""
    objects, colors = (sorted({pair[i] for pair in pairs}) for i in (0, 1))
    options = [
        (a, p, objects.index(pair[0]), colors.index(pair[1]), i)
        for a in range(len(actions))
        for p in range(len(places))
        for i, pair in enumerate(pairs)
    ]
    seed, *rest = names
    rng = generator(seed, "design", *rest, block)
    table = np.array(options, dtype=np.int64)
    chosen = spread(rng, table[:, :4], block_size(actions, places, pairs))
    return tuple((actions[a], places[p], pairs[i]) for a, p, _, _, i in table[chosen])


def spread(rng: np.random.Generator, options: Ints, count: int) -> Ints:
    """Choose options one after the other, so that values are used equally often and meet each other equally often.

    Of all sequences of one length the best are followed on (beam search): those in which no value of a column is used
    more often than another one by 2, and of these the ones in which the counts of `_TABLES` have the smallest sum of
    squares. Ties are decided by chance.

    Args:
        rng: Decides ties.
        options: (C, 4) values 0, 1, … of the channels in each option.
        count: How many to choose.

    Returns:
        (count,) rows of `options`.
    """
    sizes = options.max(axis=0) + 1
    tables = [((column,), 0) for column in range(options.shape[1])] + list(_TABLES.items())
    starts = np.cumsum([0, *(math.prod(sizes[list(columns)]) for columns, _ in tables)])
    # (tables, C): the cell of each table that an option counts in, all tables one after the other.
    cells = np.array(
        [
            start + np.ravel_multi_index(tuple(options[:, list(columns)].T), tuple(sizes[list(columns)]))
            for start, (columns, _) in zip(starts, tables, strict=False)
        ]
    )
    weights = np.array([weight for _, weight in tables])[:, None]
    followed = max(1, min(_SEQUENCES, _OPTIONS // len(options)))
    counts, cost = np.zeros((1, starts[-1]), dtype=np.int64), np.zeros(1, dtype=np.int64)
    unfair = 1 + int(weights.sum()) * count**2  # more than all tables together can cost
    steps: list[tuple[Ints, Ints]] = []
    for _ in range(count):
        now = counts[:, cells]
        ahead = sum(
            now[:, column] - counts[:, starts[column] : starts[column + 1]].min(axis=1)[:, None]
            for column in range(len(sizes))
        )
        costs = (cost[:, None] + unfair * ahead + (weights * now).sum(axis=1)).ravel()
        best = np.lexsort((rng.random(len(costs)), costs))[:followed]
        origin, option = np.divmod(best, len(options))
        counts, cost = counts[origin], costs[best]
        counts[np.arange(len(best))[:, None], cells[:, option].T] += 1
        steps.append((origin, option))
    return _traced(steps)


def _traced(steps: Sequence[tuple[Ints, Ints]]) -> Ints:
    """Return the options of the best sequence, from the steps of all: where each came from, and its option."""
    row, options = 0, []
    for origin, option in reversed(steps):
        options.append(option[row])
        row = int(origin[row])
    return np.array(options[::-1], dtype=np.int64)
