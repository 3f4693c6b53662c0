"""Two channels exchange their words, in the sentences that hold a word in one of them.

The frames change in a fixed way, an involution; the categories of both channels' speakers of these trials are drawn
anew, one trial after the other. Accept with (p/q)(new) / (p/q)(present), both along the same order of trials, and the
probability of the orders of channels where that is learned. Words of no channel stay what they are.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Ints
from model.distributions.choices import draw_other, shuffle
from model.distributions.dirichlet import draw_index, log_total
from model.kernels.frame_paths import last_state, orders_log_mass
from model.kernels.mixing.counts import element_log_weights, join
from model.kernels.mixing.setup import Setup, Tables
from model.kernels.mixing.trial_block import categories_of, put_back, take_out


@compiled
def exchange(rng: np.random.Generator, setup: Setup, tables: Tables, word: int) -> bool:
    """Try to exchange two channels in the sentences that hold a word in either; tells whether it was accepted."""
    C, D = setup.speaker.shape
    if not setup.framed or C < 2:
        return False
    x = int(rng.random() * C)
    y = draw_other(rng, C, x)
    if x > y:
        x, y = y, x
    trials, size = np.empty(D, dtype=np.int64), 0
    for d in setup.word_trials[setup.trials_of_word[word] : setup.trials_of_word[word + 1]]:
        concerned = False
        for t in range(setup.bounds[d], setup.bounds[d + 1]):
            here = tables.F[t] == x or tables.F[t] == y
            concerned = concerned or (setup.words[0, t] == word and here)
        if concerned:
            trials[size] = d
            size += 1
    if size == 0:
        return False
    trials, channels = trials[:size], np.array([x, y])
    shuffle(rng, trials)
    before = categories_of(setup, tables, trials, channels)
    take_out(setup, tables, trials, channels)
    present = orders_log_mass(setup.paths, tables.orders)
    present += _draw_back(rng, setup, tables, trials, channels, before, True)
    take_out(setup, tables, trials, channels)
    _swap(setup, tables, trials, x, y)
    new = orders_log_mass(setup.paths, tables.orders)
    new += _draw_back(rng, setup, tables, trials, channels, before, False)
    if math.log(rng.random()) < new - present:
        return True
    take_out(setup, tables, trials, channels)
    _swap(setup, tables, trials, x, y)
    for p in range(size):
        put_back(setup, tables, trials[p], channels, before[p])
    return False


@compiled
def _draw_back(
    rng: np.random.Generator, setup: Setup, tables: Tables, trials: Ints, channels: Ints, before: Ints, forced: bool
) -> float:
    """Put speakers into drawn categories, or force them into those before; returns Σ log normalisers."""
    total = 0.0
    for p in range(len(trials)):
        for n in range(len(channels)):
            c, i = channels[n], setup.speaker[channels[n], trials[p]]
            log_weights = element_log_weights(setup, tables, c, i)
            total += log_total(log_weights)
            join(setup, tables, c, before[p, n] if forced else draw_index(rng, log_weights), i)
    return total


@lean
def _swap(setup: Setup, tables: Tables, trials: Ints, x: int, y: int) -> None:
    """Channels x and y change places in the frames of trials."""
    for d in trials:
        first, last = setup.bounds[d], setup.bounds[d + 1]
        if setup.along:
            tables.orders[last_state(setup.paths, tables.F, first, last)] -= 1
        for t in range(first, last):
            if tables.F[t] == x:
                tables.F[t] = y
            elif tables.F[t] == y:
                tables.F[t] = x
        if setup.along:
            tables.orders[last_state(setup.paths, tables.F, first, last)] += 1
