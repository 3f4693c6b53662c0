"""The channels change places in the frames of a set of sentences, categories as they are: Gibbs, no rejection.

The sentences are chosen without a look at F: those with a word, a random half, or all. One of the permutations of
four channels (all, where there are no more) is drawn in proportion to the words' probability under the permuted
frames, and to that of the orders of channels where it is learned. Words of no channel stay what they are. The orbit
of F under the permutations is the same from each of its points, so that this is a draw from a conditional.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Ints
from model.distributions.dirichlet import draw_index
from model.kernels.mixing.setup import Setup, Tables


@compiled
def permute_channels(rng: np.random.Generator, setup: Setup, tables: Tables, word: int) -> None:
    """Permute channels in the sentences with a word; for word −1 in a random half of all, for −2 in all."""
    C, D = setup.speaker.shape
    if not setup.framed or C < 2:
        return
    if word >= 0:
        trials = setup.word_trials[setup.trials_of_word[word] : setup.trials_of_word[word + 1]].copy()
    else:
        trials = np.arange(D)
        if word == -1:
            trials = trials[rng.random(D) < 0.5]
    if len(trials) == 0:
        return
    orders = setup.orders
    some = rng.permutation(C)[: orders.shape[1]]
    maps = np.empty((len(orders), C), dtype=np.int64)
    for p in range(len(orders)):
        maps[p] = np.arange(C)
        for a in range(len(some)):
            maps[p, some[a]] = some[orders[p, a]]
    _count(setup, tables, trials, maps[0], -1)  # the first is the identity
    log_weights = np.empty(len(maps))
    for p in range(len(maps)):
        log_weights[p] = _count(setup, tables, trials, maps[p], 1)
        _count(setup, tables, trials, maps[p], -1)
    chosen = draw_index(rng, log_weights)
    _count(setup, tables, trials, maps[chosen], 1)
    for d in trials:
        for t in range(setup.bounds[d], setup.bounds[d + 1]):
            if tables.F[t] < C:
                tables.F[t] = maps[chosen, tables.F[t]]


@lean
def _count(setup: Setup, tables: Tables, trials: Ints, permutation: Ints, change: int) -> float:
    """Count the words of trials under permuted frames (1), or take them out (−1); log p of those that are counted.

    Where the order of channels is learned its probability is part of it.
    """
    total, C, paths = 0.0, len(setup.size), setup.paths
    for d in trials:
        state = 0
        for t in range(setup.bounds[d], setup.bounds[d + 1]):
            if tables.F[t] == C:
                continue
            c = permutation[tables.F[t]]
            if setup.along:
                state = paths.follow[state, c]
            k, w = tables.z[c, setup.speaker[c, d]], setup.words[c, t]
            if change > 0:
                total += setup.log_c[c, tables.words[c, k, w]] - setup.log_t[c, tables.total[c, k]]
            tables.words[c, k, w] += change
            tables.total[c, k] += change
        if setup.along:
            if paths.learned and change > 0:
                total += math.log(tables.orders[state] + paths.share[state])
            tables.orders[state] += change
    return total
