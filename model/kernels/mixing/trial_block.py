"""The frame of one trial and the categories of all its speakers, drawn together: Gibbs, no rejection.

The weight of a frame that sends the words S_c to channel c is ∏_c M_c(S_c), M_c(S) = Σ_k G_c(k) W_c(k, S), with
G_c(k) = (n_k + α/K) · p(x | k) of the channel's speaker and W_c(k, S) the Dirichlet-categorical probability of the
words. Sums over frames are sums over subsets of the words, channel by channel, so that frames are never listed.
Long sentences of a prior that factorises are drawn in parts, given the frames of the other words.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Floats, Ints
from model.distributions.choices import draw_weighted
from model.distributions.dirichlet import draw_index, log_total
from model.kernels.mixing.counts import (
    count_frame,
    count_words,
    element_log_weight,
    element_log_weights,
    join,
    leave,
    log_words,
)
from model.kernels.mixing.path_block import draw_along_paths
from model.kernels.mixing.setup import Setup, Tables
from model.kernels.mixing.silent import move


@compiled
def sweep_trials(rng: np.random.Generator, setup: Setup, tables: Tables) -> None:
    """Draw frame and speakers' categories of each trial, a sentence or a part of it at a time."""
    C, D = setup.speaker.shape
    chosen = np.empty(C, dtype=np.int64)
    for d in range(D):
        first, last = setup.bounds[d], setup.bounds[d + 1]
        start = first
        while True:
            part = np.arange(start, min(last, start + setup.joint))
            count_frame(setup, tables, d, -1)
            for c in range(C):
                count_words(setup, tables, c, d, tables.z[c, setup.speaker[c, d]], -1)
            draw_trial(rng, setup, tables, d, part, -1, 0, chosen)
            for c in range(C):
                move(setup, tables, c, setup.speaker[c, d], chosen[c])
                count_words(setup, tables, c, d, chosen[c], 1)
            count_frame(setup, tables, d, 1)
            start += setup.joint
            if start >= last:
                break


@compiled
def categories_of(setup: Setup, tables: Tables, trials: Ints, channels: Ints) -> Ints:
    """(trials, channels) the categories of the speakers."""
    z = np.empty((len(trials), len(channels)), dtype=np.int64)
    for p in range(len(trials)):
        for n in range(len(channels)):
            z[p, n] = tables.z[channels[n], setup.speaker[channels[n], trials[p]]]
    return z


@lean
def take_out(setup: Setup, tables: Tables, trials: Ints, channels: Ints) -> None:
    """Take the speakers of some trials and their words out of some channels."""
    for d in trials:
        for c in channels:
            leave(setup, tables, c, setup.speaker[c, d])


@lean
def put_back(setup: Setup, tables: Tables, d: int, channels: Ints, z: Ints) -> None:
    """Put the speakers of trial d into categories z, one per channel, and its words."""
    for n in range(len(channels)):
        join(setup, tables, channels[n], z[n], setup.speaker[channels[n], d])


@compiled
def draw_trial(
    rng: np.random.Generator, setup: Setup, tables: Tables, d: int, part: Ints, word: int, channel: int, chosen: Ints
) -> float:
    """Draw the frames of some words of trial d, and categories of its speakers, given all else; returns log Z.

    Z is the sum of the weights over all that could be drawn.

    Args:
        rng: The fit's generator.
        setup: The problem.
        tables: The words of trial d are in no count; F of the part's words is changed, z is not.
        d: The trial.
        part: (n,) positions of the words.
        word: A word of which all tokens of the part go to `channel`; −1 for none.
        channel: See `word`.
        chosen: (C,) receives the categories.

    Returns:
        log Z; −inf if nothing can be drawn, and then F and `chosen` are not changed.
    """
    C, n = len(setup.size), len(part)
    if not setup.framed:
        return _draw_unframed(rng, setup, tables, d, chosen)
    if setup.along:
        return draw_along_paths(rng, setup, tables, d, word, channel, chosen)
    K, sets, sources = setup.categories.max(), 1 << n, C + setup.none
    for t in part:
        tables.F[t] -= C + 1  # negative: not explained for now
    weights, mass = np.zeros((sources, K, sets)), np.zeros((sources, sets))
    log_z = 0.0
    for c in range(sources):
        log_z += _weigh_channel(setup, tables, c, d, part, word, channel, weights[c], mass[c])
    if setup.none:
        _weigh_named(setup, tables, d, n, mass[C])
    upto = np.zeros((sources, sets))  # Σ over how sources 0 to c explain a set of words
    upto[0] = mass[0]
    for c in range(1, sources):
        _convolve(upto[c - 1], mass[c], upto[c], n, setup.most)
    everything = sets - 1
    total = upto[sources - 1, everything]
    if not total > 0.0:
        for t in part:
            tables.F[t] += C + 1
        return -np.inf
    left = everything
    for c in range(sources - 1, -1, -1):
        mine = left if c == 0 else _draw_subset(rng, upto[c - 1], mass[c], left)
        left ^= mine
        for m in range(n):
            if mine >> m & 1:
                tables.F[part[m]] = c
        if c < C:
            chosen[c] = draw_weighted(rng, weights[c, :, mine])
    return float(log_z + math.log(total))


@compiled
def _draw_unframed(rng: np.random.Generator, setup: Setup, tables: Tables, d: int, chosen: Ints) -> float:
    """As `draw_trial` where each channel explains all words: the channels are independent."""
    log_z = 0.0
    for c in range(len(setup.size)):
        log_weights = element_log_weights(setup, tables, c, setup.speaker[c, d])
        log_z += log_total(log_weights)
        chosen[c] = draw_index(rng, log_weights)
    return log_z


@lean
def _weigh_channel(
    setup: Setup,
    tables: Tables,
    c: int,
    d: int,
    part: Ints,
    word: int,
    channel: int,
    weights: Floats,
    mass: Floats,
) -> float:
    """Set G(k) W(k, S) (K, 2^n) and M(S) (2^n,) of channel c, both divided by a number whose log is returned.

    For ∅, c = C, there is one category, and no element.
    """
    n, none = len(part), c == len(setup.size)
    K = 1 if none else setup.categories[c]
    top = -np.inf
    for k in range(K):  # with the words that are not in the part
        if none:
            weight = log_words(setup, tables, c, d, k)
        else:
            weight = element_log_weight(setup, tables, c, k, setup.speaker[c, d])
        weights[k, 0] = weight
        top = max(top, weight)
    fixed = 0
    for t in range(setup.bounds[d], setup.bounds[d + 1]):
        fixed += tables.F[t] == c
    for k in range(K):
        weights[k, 0] = math.exp(weights[k, 0] - top)
    for s in range(1, 1 << n):
        last = 0
        while s >> (last + 1):
            last += 1
        before, w, equal, shared = s ^ (1 << last), setup.words[c, part[last]], 0, fixed
        for m in range(last):
            if before >> m & 1:
                shared += 1
                equal += setup.words[c, part[m]] == w
        if shared + 1 > setup.most:
            continue
        if fixed:
            for t in range(setup.bounds[d], setup.bounds[d + 1]):
                equal += tables.F[t] == c and setup.words[c, t] == w
        for k in range(K):
            count, whole = tables.words[c, k, w] + equal, tables.total[c, k] + shared
            weights[k, s] = weights[k, before] * math.exp(setup.log_c[c, count] - setup.log_t[c, whole])
    for s in range(1 << n):
        possible = True
        if word >= 0:
            for m in range(n):
                if setup.words[c, part[m]] == word:
                    possible = possible and (s >> m & 1 == 1) == (c == channel)
        if possible:
            for k in range(K):
                mass[s] += weights[k, s]
    return float(top)


@lean
def _weigh_named(setup: Setup, tables: Tables, d: int, n: int, mass: Floats) -> None:
    """Multiply M(S) (2^n,) of ∅ by the prior of a frame that sends the words of S there, the part's others not."""
    C, first, last, named = len(setup.size), setup.bounds[d], setup.bounds[d + 1], 0
    for t in range(first, last):
        named += 0 <= tables.F[t] < C
    for s in range(1 << n):
        size = 0
        for m in range(n):
            size += s >> m & 1
        mass[s] *= math.exp(setup.log_named[last - first, named + n - size])


@lean
def _convolve(left: Floats, right: Floats, result: Floats, n: int, most: int) -> None:
    """Set result[U] = Σ_{S ⊆ U} left[U ∖ S] right[S]; right is 0 for sets of more than `most` words."""
    for whole in range(1 << n):
        total = left[whole] * right[0]
        if most == 1:
            for m in range(n):
                one = 1 << m
                if whole & one:
                    total += left[whole ^ one] * right[one]
        else:
            s = whole
            while s:
                total += left[whole ^ s] * right[s]
                s = (s - 1) & whole
        result[whole] = total


@lean
def _draw_subset(rng: np.random.Generator, left: Floats, right: Floats, whole: int) -> int:
    """A subset S of `whole`, with probability in proportion to left[whole ∖ S] right[S]."""
    total, s = 0.0, whole
    while True:
        total += left[whole ^ s] * right[s]
        if s == 0:
            break
        s = (s - 1) & whole
    threshold, chosen, s = rng.random() * total, 0, whole
    while True:
        weight = left[whole ^ s] * right[s]
        if weight > 0.0:
            chosen = s
            threshold -= weight
            if threshold < 0.0:
                break
        if s == 0:
            break
        s = (s - 1) & whole
    return chosen
