"""An element goes to another category of its channel, and others of its own category may follow.

Element i goes from category k to a target l. In random order each other element of k stays or follows, drawn from its
conditional given all before: log q is the sum of the logs of these probabilities. The way back, from the state that
results: i goes from l to k, and in random order each other element of l stays or goes to k, forced to what was.

    accept with  p(new) q(back) r(k) / (p(present) q r(l))

where r is the probability of the target: another element j is drawn, and its category is the target, or one of the E
empty ones if it is that of i. The two random orders have the same probability in both directions.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, inlined, lean
from model.data import Ints
from model.distributions.choices import draw_other, shuffle
from model.kernels.mixing.counts import (
    category_log_mass,
    count_empty,
    count_words,
    draw_empty,
    element_log_weight,
    join,
    leave,
)
from model.kernels.mixing.setup import Setup, Tables


@compiled
def move_group(rng: np.random.Generator, setup: Setup, tables: Tables, c: int) -> bool:
    """Try to move an element of channel c, and those that follow it; tells whether it was accepted."""
    N = setup.size[c]
    if N < 2 or setup.categories[c] < 2:
        return False
    i = int(rng.random() * N)
    k, target = tables.z[c, i], tables.z[c, draw_other(rng, N, i)]
    empty = count_empty(setup, tables, c)
    if target == k:
        if empty == 0:
            return False
        target = draw_empty(rng, setup, tables, c, empty)
    log_ratio = -_log_target(tables, c, k, target, empty)
    log_ratio -= category_log_mass(setup, tables, c, k) + category_log_mass(setup, tables, c, target)
    was = tables.z[c].copy()
    log_ratio -= _move_along(rng, setup, tables, c, i, target, _others(rng, tables, c, i), was, False)
    log_ratio += category_log_mass(setup, tables, c, k) + category_log_mass(setup, tables, c, target)
    log_ratio += _log_target(tables, c, target, k, count_empty(setup, tables, c))
    moved = tables.members[c, target, : tables.n[c, target]].copy()
    log_ratio += _move_along(rng, setup, tables, c, i, k, _others(rng, tables, c, i), was, True)
    if not math.log(rng.random()) < log_ratio:
        return False
    for x in moved:
        if was[x] == k:
            _give(setup, tables, c, x, target)
    return True


@inlined
def _log_target(tables: Tables, c: int, k: int, target: int, empty: int) -> float:
    """Log (N − 1) r(l), the probability of the target for an element of k."""
    if tables.n[c, target] > 0:
        return math.log(tables.n[c, target])
    return math.log(tables.n[c, k] - 1) - math.log(empty)


@compiled
def _others(rng: np.random.Generator, tables: Tables, c: int, i: int) -> Ints:
    """The other elements of the category of i, in random order."""
    k = tables.z[c, i]
    order, m = np.empty(tables.n[c, k] - 1, dtype=np.int64), 0
    for x in tables.members[c, k, : tables.n[c, k]]:
        if x != i:
            order[m] = x
            m += 1
    shuffle(rng, order)
    return order


@lean
def _give(setup: Setup, tables: Tables, c: int, x: int, k: int) -> None:
    """Element x to category k, with its words."""
    leave(setup, tables, c, x)
    join(setup, tables, c, k, x)


@lean
def _move_along(
    rng: np.random.Generator,
    setup: Setup,
    tables: Tables,
    c: int,
    i: int,
    target: int,
    order: Ints,
    was: Ints,
    forced: bool,
) -> float:
    """Move i to the target, and of the elements in order those that follow, drawn or forced to what was; log q."""
    k = tables.z[c, i]
    _give(setup, tables, c, i, target)
    log_q = 0.0
    for x in order:
        d = setup.owner[c, x]
        if d >= 0:
            count_words(setup, tables, c, d, k, -1)
        stays, follows = element_log_weight(setup, tables, c, k, x), element_log_weight(setup, tables, c, target, x)
        if d >= 0:
            count_words(setup, tables, c, d, k, 1)
        top = max(stays, follows)
        log_total = top + math.log(math.exp(stays - top) + math.exp(follows - top))
        goes = was[x] == target if forced else rng.random() < math.exp(follows - log_total)
        log_q += (follows if goes else stays) - log_total
        if goes:
            _give(setup, tables, c, x, target)
    return float(log_q)
