"""Draws of frames, and sums over them, along the states of `model.frame_paths`; channel number C is no channel.

With weights q_n(x) of word n under source x, and e(s) of the last state, a frame f that ends in s has the weight
e(s) ∏_n q_n(f_n). Forward, the sums over all beginnings of frames that lead to a state; backward, the draw.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Flags, Floats, Ints
from model.distributions.dirichlet import draw_index, log_total
from model.frame_paths import ORDER_CONCENTRATION, Paths


@lean
def last_state(paths: Paths, F: Ints, first: int, last: int) -> int:
    """The state in which the frame of the words first to last − 1 ends."""
    state = 0
    for t in range(first, last):
        if F[t] < paths.follow.shape[1]:
            state = paths.follow[state, F[t]]
    return state


@compiled
def count_states(paths: Paths, F: Ints, bounds: Ints) -> Ints:
    """(S,) how many sentences, with words bounds[d] to bounds[d + 1] − 1, end in each state."""
    counts = np.zeros(len(paths.size), dtype=np.int64)
    for d in range(len(bounds) - 1):
        counts[last_state(paths, F, bounds[d], bounds[d + 1])] += 1
    return counts


@compiled
def frames_log_prior(paths: Paths, F: Ints, bounds: Ints) -> float:
    """Log p(F) of allowed frames, λ integrated out where it is learned."""
    total = 0.0
    for d in range(len(bounds) - 1):
        total += paths.log_prior[bounds[d + 1] - bounds[d], last_state(paths, F, bounds[d], bounds[d + 1])]
    if paths.learned:
        counts = count_states(paths, F, bounds)
        total += orders_log_mass(paths, counts)
        by_size = np.zeros(paths.follow.shape[1] + 1)
        for s in range(len(counts)):
            by_size[paths.size[s]] += counts[s]
        for count in by_size:
            total += math.lgamma(ORDER_CONCENTRATION) - math.lgamma(ORDER_CONCENTRATION + count)
    return float(total)


@lean
def orders_log_mass(paths: Paths, counts: Ints) -> float:
    """Log p of the orders in these numbers, but for what hangs only on how many channels they have."""
    total = 0.0
    if paths.learned:
        for s in range(len(counts)):
            if counts[s] > 0:
                total += math.lgamma(counts[s] + paths.share[s]) - math.lgamma(paths.share[s])
    return total


@compiled
def end_log_weights(paths: Paths, length: int, counts: Ints) -> Floats:
    """(S,) log probability of a frame of some words by its last state, given how often others end there."""
    result: Floats = paths.log_prior[length].copy()
    if paths.learned:
        totals = np.full(paths.follow.shape[1] + 1, ORDER_CONCENTRATION)
        for s in range(len(counts)):
            totals[paths.size[s]] += counts[s]
        for s in range(len(counts)):
            result[s] += math.log((counts[s] + paths.share[s]) / totals[paths.size[s]])
    return result


@compiled
def path_log_sums(paths: Paths, log_weights: Floats) -> Floats:
    """(N + 1, S) log of the sums over the frames of the first n words that lead to a state.

    Args:
        paths: The states.
        log_weights: (N, C + 1) log q; −inf for what is not possible.
    """
    N, C, S = len(log_weights), paths.follow.shape[1], len(paths.size)
    upto = np.full((N + 1, S), -np.inf)
    upto[0, 0] = 0.0
    for n in range(N):
        for s in range(S):
            if paths.size[s] > n + 1:
                continue
            top = upto[n, s] + log_weights[n, C]
            for c in range(C):
                if paths.before[s, c] >= 0:
                    top = max(top, upto[n, paths.before[s, c]] + log_weights[n, c])
            if top == -np.inf:
                continue
            total = math.exp(upto[n, s] + log_weights[n, C] - top)
            for c in range(C):
                if paths.before[s, c] >= 0:
                    total += math.exp(upto[n, paths.before[s, c]] + log_weights[n, c] - top)
            upto[n + 1, s] = top + math.log(total)
    return upto


@compiled
def draw_path(rng: np.random.Generator, paths: Paths, log_weights: Floats, log_end: Floats, frame: Ints) -> float:
    """Draw the frame (N,) of a sentence, in place; returns the log of the sum over all frames.

    Args:
        rng: The fit's generator.
        paths: The states.
        log_weights: (N, C + 1) log q.
        log_end: (S,) log e.
        frame: Receives the draw; not changed where the sum is 0.
    """
    N, C = len(log_weights), paths.follow.shape[1]
    upto = path_log_sums(paths, log_weights)
    ends = upto[N] + log_end
    log_z = log_total(ends)
    if log_z == -np.inf:
        return -np.inf
    state, ways = draw_index(rng, ends), np.empty(C + 1)
    for n in range(N - 1, -1, -1):
        ways[C] = upto[n, state] + log_weights[n, C]
        for c in range(C):
            ways[c] = -np.inf
            if paths.before[state, c] >= 0:
                ways[c] = upto[n, paths.before[state, c]] + log_weights[n, c]
        frame[n] = draw_index(rng, ways)
        if frame[n] < C:
            state = paths.before[state, frame[n]]
    return log_z


@lean
def mark_free(rng: np.random.Generator, words: Ints, first: int, last: int, at_random: bool, free: Flags) -> None:
    """Choose, of the tokens of each word among first to last − 1, the one whose source is drawn; the others are held.

    θ of no channel is integrated out, so that two tokens of one word are not independent there; different words are,
    given how many there are. Which token it is hangs on nothing that a draw changes.

    Args:
        rng: The fit's generator.
        words: (T,) index into the vocabulary.
        first: The first word.
        last: Behind the last.
        at_random: Any of the tokens, else the first.
        free: (last − first,) receives the choice.
    """
    for t in range(first, last):
        equal, earlier = 0, 0
        for e in range(first, last):
            if words[e] == words[t]:
                equal += 1
                earlier += e < t
        if earlier == 0:
            which = int(rng.random() * equal) if at_random and equal > 1 else 0
            for e in range(t, last):
                if words[e] == words[t]:
                    free[e - first] = which == 0
                    which -= 1


@lean
def held_before(words: Ints, F: Ints, none: int, first: int, last: int, t: int, free: Flags) -> int:
    """How many held tokens of the same word are of no channel: all, seen from the free one; else those before t."""
    held = 0
    for e in range(first, last):
        if words[e] == words[t] and not free[e - first] and F[e] == none and (free[t - first] or e < t):
            held += 1
    return held
