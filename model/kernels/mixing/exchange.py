"""Two channels exchange their words, in the sentences that hold a word in one of them.

The frames change in a fixed way, an involution; the categories of both channels' speakers of these trials are drawn
anew, one trial after the other. Accept with (p/q)(new) / (p/q)(present), both along the same order of trials.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Ints
from model.distributions.dirichlet import draw_index, log_total
from model.kernels.mixing.counts import count_words, element_log_weight
from model.kernels.mixing.gaussians import attach, detach
from model.kernels.mixing.setup import Setup, Tables


@compiled
def exchange(rng: np.random.Generator, setup: Setup, tables: Tables, word: int) -> bool:
    """Try to exchange two channels in the sentences that hold a word in either; tells whether it was accepted."""
    C, D = setup.speaker.shape
    if not setup.framed or C < 2:
        return False
    x = int(rng.random() * C)
    y = int(rng.random() * (C - 1))
    if y >= x:
        y += 1
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
    trials = trials[:size]
    for p in range(size - 1, 0, -1):
        q = int(rng.random() * (p + 1))
        trials[p], trials[q] = trials[q], trials[p]
    before = np.empty((size, 2), dtype=np.int64)
    for p in range(size):
        before[p, 0], before[p, 1] = (
            tables.z[x, setup.speaker[x, trials[p]]],
            tables.z[y, setup.speaker[y, trials[p]]],
        )
    _take_out_pair(setup, tables, trials, x, y)
    present = _put_back_pair(rng, setup, tables, trials, x, y, before, True)
    _take_out_pair(setup, tables, trials, x, y)
    _swap(setup, tables, trials, x, y)
    new = _put_back_pair(rng, setup, tables, trials, x, y, before, False)
    if math.log(rng.random()) < new - present:
        return True
    _take_out_pair(setup, tables, trials, x, y)
    _swap(setup, tables, trials, x, y)
    for p in range(size):
        _place(setup, tables, x, trials[p], before[p, 0])
        _place(setup, tables, y, trials[p], before[p, 1])
    return False


@lean
def _take_out_pair(setup: Setup, tables: Tables, trials: Ints, x: int, y: int) -> None:
    """Take the speakers of two channels and their words out."""
    for d in trials:
        for c in (x, y):
            i = setup.speaker[c, d]
            count_words(setup, tables, c, d, tables.z[c, i], -1)
            detach(setup, tables, c, i)


@compiled
def _put_back_pair(
    rng: np.random.Generator, setup: Setup, tables: Tables, trials: Ints, x: int, y: int, before: Ints, forced: bool
) -> float:
    """Put speakers of two channels into drawn categories, or forced into those before; returns Σ log normalisers."""
    total = 0.0
    for p in range(len(trials)):
        for side in range(2):
            c = x if side == 0 else y
            i = setup.speaker[c, trials[p]]
            log_weights = np.empty(setup.categories[c])
            for k in range(len(log_weights)):
                log_weights[k] = element_log_weight(setup, tables, c, k, i)
            total += log_total(log_weights)
            k = before[p, side] if forced else draw_index(rng, log_weights)
            _place(setup, tables, c, trials[p], k)
    return total


@lean
def _place(setup: Setup, tables: Tables, c: int, d: int, k: int) -> None:
    attach(setup, tables, c, k, setup.speaker[c, d])
    count_words(setup, tables, c, d, k, 1)


@lean
def _swap(setup: Setup, tables: Tables, trials: Ints, x: int, y: int) -> None:
    """Channels x and y change places in the frames of trials."""
    for d in trials:
        for t in range(setup.bounds[d], setup.bounds[d + 1]):
            if tables.F[t] == x:
                tables.F[t] = y
            elif tables.F[t] == y:
                tables.F[t] = x
