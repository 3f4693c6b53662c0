"""The frame of one trial along paths, and the categories of its speakers, drawn together: Gibbs, no rejection.

Each channel explains at most one word, so that, with M_c(S) as in `trial_block`, word n of channel c has the weight
q_n(c) = M_c({n}) / M_c(∅) beside ∏_c M_c(∅). Words of no channel are as in `model.kernels.collapsed_paths`.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Floats, Ints
from model.distributions.choices import draw_weighted
from model.kernels.frame_paths import draw_path, end_log_weights, held_before, mark_free
from model.kernels.mixing.counts import log_prior_and_density
from model.kernels.mixing.setup import Setup, Tables


@compiled
def draw_along_paths(
    rng: np.random.Generator, setup: Setup, tables: Tables, d: int, word: int, channel: int, chosen: Ints
) -> float:
    """Draw the frame of trial d and categories of its speakers, as `trial_block.draw_trial` does."""
    C, first, last = len(setup.size), setup.bounds[d], setup.bounds[d + 1]
    free = np.ones(last - first, dtype=np.bool_)
    if setup.none:
        mark_free(rng, setup.words[0], first, last, word < 0, free)
    weights, log_weights = np.zeros((C, setup.categories.max())), np.full((last - first, C + 1), -np.inf)
    log_z = 0.0
    for c in range(C):
        log_z += _weigh_channel(setup, tables, c, d, weights[c])
        for t in range(first, last):
            if _possible(setup, tables, t, c, word, channel, free[t - first]):
                log_weights[t - first, c] = math.log(_weigh_word(setup, tables, c, t, weights[c]))
    for t in range(first, last):
        if setup.none and _possible(setup, tables, t, C, word, channel, free[t - first]):
            held = held_before(setup.words[0], tables.F, C, first, last, t, free)
            log_weights[t - first, C] = setup.log_c[C, tables.words[C, 0, setup.words[0, t]] + held]
    log_sum = draw_path(rng, setup.paths, log_weights, _log_end(setup, tables, last - first), tables.F[first:last])
    if log_sum == -np.inf:
        return -np.inf
    for t in range(first, last):
        c = tables.F[t]
        if c < C:
            for k in range(setup.categories[c]):
                weights[c, k] *= _predicted(setup, tables, c, k, t)
    for c in range(C):
        chosen[c] = draw_weighted(rng, weights[c])
    return log_z + log_sum


@lean
def _weigh_channel(setup: Setup, tables: Tables, c: int, d: int, weights: Floats) -> float:
    """Set G(k) of channel c's speaker, divided by their sum, whose log is returned."""
    K, i, top, total = setup.categories[c], setup.speaker[c, d], -np.inf, 0.0
    for k in range(K):
        weights[k] = log_prior_and_density(setup, tables, c, k, i)
        top = max(top, weights[k])
    for k in range(K):
        weights[k] = math.exp(weights[k] - top)
        total += weights[k]
    for k in range(K):
        weights[k] /= total
    return float(top + math.log(total))


@lean
def _possible(setup: Setup, tables: Tables, t: int, source: int, word: int, channel: int, free: bool) -> bool:
    """Whether word t may be of a source: a held one stays; tokens of `word` go to `channel`."""
    if setup.words[0, t] == word:
        return source == channel
    return free or tables.F[t] == source


@lean
def _weigh_word(setup: Setup, tables: Tables, c: int, t: int, weights: Floats) -> float:
    """Σ_k G(k) p(word t | k), G normalised."""
    total = 0.0
    for k in range(setup.categories[c]):
        total += weights[k] * _predicted(setup, tables, c, k, t)
    return total


@lean
def _predicted(setup: Setup, tables: Tables, c: int, k: int, t: int) -> float:
    """The probability of word t under category k, given the words that it explains."""
    return math.exp(setup.log_c[c, tables.words[c, k, setup.words[c, t]]] - setup.log_t[c, tables.total[c, k]])


@compiled
def _log_end(setup: Setup, tables: Tables, length: int) -> Floats:
    """(S,) log weight of a sentence's last state: the prior's, and the denominator of its words of no channel."""
    C, result = len(setup.size), end_log_weights(setup.paths, length, tables.orders)
    if setup.none:
        for s in range(len(result)):
            for i in range(length - setup.paths.size[s]):
                result[s] -= setup.log_t[C, tables.total[C, 0] + i]
    return result
