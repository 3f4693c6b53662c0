"""The collapsed sampler's conditional of F along the states of a frame, one sentence given all others.

The words that channels explain are independent given that none is explained twice. Words of no channel share θ^∅,
integrated out: n of them have the denominator ∏_{i<n} (n^∅ + Wγ + i), which hangs on the last state alone, and
different words have factors of their own. Of equal words all but one are held, see `frame_paths.mark_free`.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Flags, Floats, Ints
from model.frame_paths import Paths
from model.kernels.frame_paths import count_states, draw_path, end_log_weights, held_before, last_state, mark_free
from model.kernels.word_table import WordTable, count_part


@compiled
def swept_along_paths(
    rng: np.random.Generator, F: Ints, temperature: float, words: Ints, bounds: Ints, table: WordTable, paths: Paths
) -> Ints:
    """Draw F (T,) sentence by sentence.

    Args:
        rng: The fit's generator.
        F: (T,) frames before.
        temperature: Divides the log weights; 1 for the posterior.
        words: (T,) index into the vocabulary.
        bounds: (D + 1,) the words of trial d are bounds[d] to bounds[d + 1] − 1.
        table: Counts under F; used up.
        paths: The states of the frames.
    """
    F, counts = F.copy(), count_states(paths, F, bounds)
    for d in range(len(bounds) - 1):
        first, last = bounds[d], bounds[d + 1]
        counts[last_state(paths, F, first, last)] -= 1
        count_part(table, words, F, first, last - first, -1.0)
        free = np.ones(last - first, dtype=np.bool_)
        if paths.none:
            mark_free(rng, words, first, last, True, free)
        log_weights = source_log_weights(table, words, F, first, last, free, paths)
        log_end = sentence_log_end(table, last - first, counts, paths)
        draw_path(rng, paths, log_weights / temperature, log_end / temperature, F[first:last])
        count_part(table, words, F, first, last - first, 1.0)
        counts[last_state(paths, F, first, last)] += 1
    return F


@compiled
def source_log_weights(
    table: WordTable, words: Ints, F: Ints, first: int, last: int, free: Flags, paths: Paths
) -> Floats:
    """(N, C + 1) log weights of the words first to last − 1 under each source, −inf where a held word is not."""
    C, W = paths.follow.shape[1], table.counts.shape[1]
    result = np.full((last - first, C + 1), -np.inf)
    for t in range(first, last):
        for c in range(C):
            if free[t - first] or F[t] == c:
                row = table.row[c, t]
                gamma = table.gamma[row]
                whole = table.totals[row] + W * gamma
                result[t - first, c] = math.log((table.counts[row, words[t]] + gamma) / whole)
        if paths.none and (free[t - first] or F[t] == C):
            row = table.row[C, t]
            held = held_before(words, F, C, first, last, t, free)
            result[t - first, C] = math.log(table.counts[row, words[t]] + table.gamma[row] + held)
    return result


@compiled
def sentence_log_end(table: WordTable, length: int, counts: Ints, paths: Paths) -> Floats:
    """(S,) log weight of a sentence's last state: the prior's, and the denominator of its words of no channel."""
    result = end_log_weights(paths, length, counts)
    if paths.none:
        row, W = len(table.totals) - 1, table.counts.shape[1]
        for s in range(len(result)):
            for i in range(length - paths.size[s]):
                result[s] -= math.log(table.totals[row] + W * table.gamma[row] + i)
    return result
