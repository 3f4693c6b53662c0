"""The categories of some clusters of elements at once: Gibbs, all elements of a cluster together.

A cluster is a node of a tree over the elements of a channel, or those elements of a node whose sentences have a word
in common; trees are made once and for all (see `tree`), so that which clusters are tried hangs on nothing that a move
changes. Up to three clusters are drawn, each without the elements of those before. Those whose elements are in more
than one category now stay as they are; a move of the others does not change that. The others are taken out of their
categories, and given new ones from their joint conditional: nothing is rejected. With m(k) the weight of category k
without them,

    p(z_S = k, z_T = l | …) ∝ m(k ∪ S) / m(k) · m(l ∪ T) / m(l) if k ≠ l, m(k ∪ S ∪ T) / m(k) if k = l.

So clusters change places, meet or part over states of little probability.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Flags, Floats, Ints
from model.distributions.choices import draw_weighted
from model.kernels.mixing.counts import category_log_mass, copy_category, join, leave, put
from model.kernels.mixing.setup import SCRATCH, Setup, Tables

# Combinations of categories that are weighed: of three clusters with ten categories.
_MOST_COMBINATIONS = 1000
# Log of a weight beside the largest that cannot change a draw of double precision.
_LEAST = -45.0


@compiled
def move_clusters(rng: np.random.Generator, setup: Setup, tables: Tables, c: int) -> int:
    """Draw the categories of up to three random clusters of channel c; tells how many could move."""
    if setup.clusters[c] == 0:
        return 0
    K, wanted = setup.categories[c], 1 + int(rng.random() * SCRATCH)
    while wanted > 1 and K**wanted > _MOST_COMBINATIONS:
        wanted -= 1
    elements, bounds, used = np.empty(setup.size[c], dtype=np.int64), np.zeros(wanted + 1, dtype=np.int64), 0
    drawn = np.zeros(setup.size[c], dtype=np.bool_)
    for _ in range(wanted):
        first = bounds[used]
        size = _draw_cluster(rng, setup, c, elements[first:], drawn)
        if size > 0 and _take(setup, tables, c, elements[first : first + size]):
            used += 1
            bounds[used] = first + size
    if used == 0:
        return 0
    weights = _log_weights(_gains(setup, tables, c, elements, bounds[: used + 1]), used)
    _exponentiate(weights)
    chosen = draw_weighted(rng, weights)
    for u in range(used):
        k = chosen % K
        chosen //= K
        for i in elements[bounds[u] : bounds[u + 1]]:
            join(setup, tables, c, k, i)
    return used


@lean
def _draw_cluster(rng: np.random.Generator, setup: Setup, c: int, elements: Ints, drawn: Flags) -> int:
    """Write a random cluster's elements but those drawn before, and mark them as drawn; tells how many.

    Nodes are in order from the top, and their rank is log-uniform: large ones are as probable as the many small ones.
    """
    tree = int(rng.random() * setup.spans.shape[1])
    node = min(int(math.exp(rng.random() * math.log(setup.clusters[c] + 1.0))), setup.clusters[c]) - 1
    W, word, size = len(setup.trials_of_word) - 1, -1, 0
    if W > 0 and rng.random() < 0.5:
        word = int(rng.random() * W)
    for p in range(setup.spans[c, tree, node, 0], setup.spans[c, tree, node, 1]):
        i = setup.leaves[c, tree, p]
        if not drawn[i] and (word < 0 or _says(setup, c, setup.owner[c, i], word)):
            elements[size], drawn[i] = i, True
            size += 1
    return size


@lean
def _says(setup: Setup, c: int, d: int, word: int) -> bool:
    """Whether the sentence of trial d, if there is one, has a word."""
    said = False
    if d >= 0:
        for t in range(setup.bounds[d], setup.bounds[d + 1]):
            said = said or setup.words[c, t] == word
    return said


@lean
def _take(setup: Setup, tables: Tables, c: int, elements: Ints) -> bool:
    """Take elements and their words out of their category; False, and nothing is taken, if they have several."""
    k = tables.z[c, elements[0]]
    for i in elements:
        if tables.z[c, i] != k:
            return False
    for i in elements:
        leave(setup, tables, c, i)
    return True


@compiled
def _gains(setup: Setup, tables: Tables, c: int, elements: Ints, bounds: Ints) -> Floats:
    """(K, 2^clusters) log m(k ∪ the clusters of a set) / m(k), sets as bits; empty categories are all alike."""
    clusters, K, empty = len(bounds) - 1, setup.categories[c], -1
    gains, scratch = np.zeros((K, 2**clusters)), len(tables.n[c]) - SCRATCH
    part = np.empty(clusters, dtype=np.int64)
    for k in range(K):
        if tables.n[c, k] == 0:
            if empty >= 0:
                gains[k] = gains[empty]
                continue
            empty = k
        before = category_log_mass(setup, tables, c, k)
        # Sets in lexical order: each is one before it and a cluster more, built on a copy of that one's category.
        depth, u, chosen = 0, 0, 0
        while True:
            copy_category(setup, tables, c, k if depth == 0 else scratch + depth - 1, scratch + depth)
            for i in elements[bounds[u] : bounds[u + 1]]:
                put(setup, tables, c, scratch + depth, i)
            part[depth] = u
            chosen |= 1 << u
            gains[k, chosen] = category_log_mass(setup, tables, c, scratch + depth) - before
            if u + 1 < clusters:
                depth, u = depth + 1, u + 1
                continue
            chosen &= ~(1 << u)
            if depth == 0:
                break
            depth -= 1
            u = part[depth]
            chosen &= ~(1 << u)
            u += 1
    return gains


@compiled
def _log_weights(gains: Floats, clusters: int) -> Floats:
    """(K^clusters,) the log weights of all combinations, the first cluster's category changing fastest."""
    K, size = len(gains), 1
    weights = np.zeros(K**clusters)
    # The sums of what the clusters gain alone, one cluster more at a time.
    for u in range(clusters):
        for k in range(K - 1, -1, -1):
            for rest in range(size):
                weights[k * size + rest] = weights[rest] + gains[k, 1 << u]
        size *= K
    labels = np.zeros(clusters, dtype=np.int64)
    for combination in range(size):
        if _meet(labels):
            weights[combination] = _gain_together(gains, labels)
        u = 0
        while u < clusters and labels[u] == K - 1:
            labels[u] = 0
            u += 1
        if u < clusters:
            labels[u] += 1
    return weights


@lean
def _meet(labels: Ints) -> bool:
    """Whether any two clusters go to the same category."""
    met = False
    for u in range(1, len(labels)):
        for v in range(u):
            met = met or labels[u] == labels[v]
    return met


@lean
def _gain_together(gains: Floats, labels: Ints) -> float:
    total = 0.0
    for u in range(len(labels)):
        together, first = 0, True
        for v in range(len(labels)):
            if labels[v] == labels[u]:
                together |= 1 << v
                first = first and v >= u
        if first:
            total += gains[labels[u], together]
    return total


@lean
def _exponentiate(weights: Floats) -> None:
    """Replace log weights by weights, of which the largest is 1. What is too little to count is 0."""
    top = -np.inf
    for weight in weights:
        top = max(top, weight)
    for n in range(len(weights)):
        weights[n] = math.exp(weights[n] - top) if weights[n] - top > _LEAST else 0.0
