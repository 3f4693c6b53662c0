"""Frames word by word: a frame is a path through a few states.

A state is what a sentence has used so far: how many words have a channel, where channels may occur twice; the set of
channels, where they may not; or their order where that matters. A channel's word leads to another state, a word of no
channel leads nowhere. So sums over all frames and draws of one cost the number
of words times the number of states, and frames are never listed.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import combinations, permutations
from typing import NamedTuple

import numpy as np

from model.data import Floats, Ints

# δ, over the orders of each number of channels together.
ORDER_CONCENTRATION = 1.0


class Paths(NamedTuple):
    """The S states of frames of C channels, and the prior of the frames that end in them.

    Attributes:
        follow: (S, C) the state after a word of each channel, −1 if the channel is used already.
        before: (S, C) the state from which a word of the channel leads here, −1 for none.
        size: (S,) number of words with a channel.
        log_prior: (longest + 1, S) log probability of each single frame of N words that ends in a state; −inf where
            there is none. Where orders are learned, but for the probability λ of the order.
        share: (S,) δ divided by the number of orders of as many channels; 0 where orders are not learned.
        none: Whether words may be of no channel.
        learned: Whether the probabilities λ of orders are learned.
        once: Whether no channel occurs twice.
    """

    follow: Ints
    before: Ints
    size: Ints
    log_prior: Floats
    share: Floats
    none: bool
    learned: bool
    once: bool


@lru_cache(maxsize=64)
def log_named(channels: int, longest: int) -> Floats:
    """(longest + 1, longest + 1) log probability of a frame of N words, j of them with any channels.

    The number j is uniform on 0 to N, then which words they are, and which channel each has.
    """
    result = np.full((longest + 1, longest + 1), -np.inf)
    for N in range(longest + 1):
        for j in range(N + 1):
            result[N, j] = -math.log(N + 1) - math.log(math.comb(N, j)) - j * math.log(channels)
    return result


@lru_cache(maxsize=64)
def counting_paths(channels: int, longest: int) -> Paths:
    """The paths of frames in which channels may occur twice, with the prior of `log_named`."""
    size = np.arange(longest + 1)
    follow = np.tile(np.where(size < longest, size + 1, -1)[:, None], channels)
    before = np.tile(size[:, None] - 1, channels)
    share = np.zeros(longest + 1)
    return Paths(follow, before, size, log_named(channels, longest), share, none=True, learned=False, once=False)


@lru_cache(maxsize=64)
def paths_of(channels: int, longest: int, none: bool, learned: bool) -> Paths:
    """The paths of sentences of up to `longest` words in which no channel occurs twice.

    The number j of words with a channel is uniform on 0 to min(C, N) where words may be of no channel; else it is
    min(C, N), and N − C surplus words of an instruction have none. Which words have one is uniform, and so is the
    order of the channels unless it is learned.

    Args:
        channels: C.
        longest: Words of the longest sentence.
        none: Whether words may be of no channel.
        learned: Whether the probabilities of orders are learned.
    """
    every = permutations if learned else combinations
    states = [tuple(one) for j in range(channels + 1) for one in every(range(channels), j)]
    number = {state: s for s, state in enumerate(states)}
    follow = np.full((len(states), channels), -1, dtype=np.int64)
    before = follow.copy()
    for state, s in number.items():
        for c in range(channels):
            if c not in state:
                longer = (*state, c) if learned else tuple(sorted((*state, c)))
                follow[s, c] = number[longer]
                before[number[longer], c] = s
    size = np.array([len(state) for state in states], dtype=np.int64)
    log_prior = np.full((longest + 1, len(states)), -np.inf)
    for N in range(longest + 1):
        most = min(channels, N)
        for s, j in enumerate(size.tolist()):
            if j <= most if none else j == most:
                log_prior[N, s] = -math.log(math.comb(N, j)) - (math.log(most + 1) if none else 0.0)
                log_prior[N, s] -= 0.0 if learned else math.log(math.perm(channels, j))
    orders = np.array([math.perm(channels, j) for j in size.tolist()], dtype=np.float64)
    share = learned * ORDER_CONCENTRATION / orders
    return Paths(follow, before, size, log_prior, share, none, learned, once=True)


def orders_of(channels: int) -> tuple[tuple[int, ...], ...]:
    """(S) the order of channels that each state of learned orders stands for."""
    return tuple(one for j in range(channels + 1) for one in permutations(range(channels), j))


def order_table(channels: int) -> Ints:
    """(S, C) the same as an array, −1 behind the last channel."""
    orders = orders_of(channels)
    table = np.full((len(orders), channels), -1, dtype=np.int64)
    for s, order in enumerate(orders):
        table[s, : len(order)] = order
    return table


def log_mean_orders(paths: Paths, counts: Floats) -> Floats:
    """(S,) log of the posterior mean of λ, given how often each order was, (S,); (0,) where it is not learned."""
    if not paths.learned:
        return np.empty(0)
    totals = np.bincount(paths.size, weights=counts)[paths.size]
    return np.asarray(np.log((counts + paths.share) / (totals + ORDER_CONCENTRATION)))
