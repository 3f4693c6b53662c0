"""Split, merge and shuffle of categories of a channel, sequentially allocated (Dahl 2005, after Jain and Neal 2004).

Two elements i ≠ j are drawn, the anchors. The others of their one or two categories go one after the other beside i
or beside j, with probability in proportion to their weight (size, points, words) given those before: a path. With p
the weight of the categories and q the probability of the path, log (p/q) is the sum of the logs of its normalisers.

    split   accept with  E · ½ · (p/q)(new) / m(merged)          E: the empty labels, one of which is drawn
    merge   accept with  m(merged) / ((p/q)(present) · ½ · E′)   E′: the empty labels after it
    shuffle accept with  (p/q)(new) / (p/q)(present)

where ½ is the probability to merge rather than to shuffle, and the present division's path is forced along z in the
same order: at random, or those first that are much nearer to one anchor, see `_sort_by_confidence`.

Half of the times a third element is an anchor, too, if it is in a third category, whose elements are then allocated
anew with the others: two categories become three, three become two, and what was m(merged) is (p/q) of two.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled, lean
from model.data import Ints
from model.distributions.choices import shuffle
from model.kernels.mixing.counts import (
    category_log_mass,
    clear,
    copy_category,
    count_empty,
    count_words,
    draw_empty,
    log_words,
)
from model.kernels.mixing.gaussians import append, log_factor, log_predictive, push
from model.kernels.mixing.setup import SCRATCH, Setup, Tables

SPLIT, MERGE, SHUFFLE = 0, 1, 2
_LOG_HALF = math.log(0.5)


@compiled
def split_or_merge(rng: np.random.Generator, setup: Setup, tables: Tables, c: int) -> bool:
    """Try one split, merge or shuffle in channel c; tells whether it was accepted."""
    N, first_scratch = setup.size[c], len(tables.n[c]) - SCRATCH
    bystander, confident = rng.random() < 0.5, rng.random() < 0.5
    if N < 2 + bystander:
        return False
    anchors = _draw_anchors(rng, N, bystander)
    labels = np.empty(SCRATCH, dtype=np.int64)
    k, other = tables.z[c, anchors[0]], tables.z[c, anchors[1]]
    together = k == other
    labels[0], labels[1], present_ways = k, other, 1 if together else 2
    if bystander:
        third = tables.z[c, anchors[2]]
        if third in (k, other):
            return False
        labels[present_ways] = third
        present_ways += 1
    empty = count_empty(setup, tables, c)
    if together and empty == 0:
        return False
    order = _in_random_order(rng, tables, c, anchors, labels[:present_ways])
    if confident:
        _sort_by_confidence(setup, tables, c, order, len(anchors))
    kind = SPLIT if together else MERGE if rng.random() < 0.5 else SHUFFLE
    if present_ways == 1:
        present = category_log_mass(setup, tables, c, k)
    else:
        present = _allocate(rng, setup, tables, c, order, len(anchors), together, labels[:present_ways], True)
    ways = present_ways + (1 if kind == SPLIT else -1 if kind == MERGE else 0)
    new = _allocate(rng, setup, tables, c, order, len(anchors), kind == MERGE, labels[:ways], False)
    ratio = new - present
    if kind == SPLIT:
        ratio += _LOG_HALF + math.log(empty)
    elif kind == MERGE:
        ratio -= _LOG_HALF + math.log(empty + 1)
    if not math.log(rng.random()) < ratio:
        return False
    if kind == SPLIT:
        if bystander:
            labels[2] = labels[1]
        labels[1] = draw_empty(rng, setup, tables, c, empty)
    elif kind == MERGE:
        clear(setup, tables, c, other)
        if bystander:
            labels[1] = labels[2]
    for way in range(ways):
        _adopt(setup, tables, c, first_scratch + way, labels[way])
    return True


@compiled
def _draw_anchors(rng: np.random.Generator, N: int, bystander: bool) -> Ints:
    """Two elements, or three, all different."""
    anchors = np.empty(3 if bystander else 2, dtype=np.int64)
    for a in range(len(anchors)):
        while True:
            anchors[a] = int(rng.random() * N)
            fresh = True
            for b in range(a):
                fresh = fresh and anchors[b] != anchors[a]
            if fresh:
                break
    return anchors


@compiled
def _in_random_order(rng: np.random.Generator, tables: Tables, c: int, anchors: Ints, labels: Ints) -> Ints:
    """The elements of some categories: first the anchors, then the others in random order."""
    size = 0
    for k in labels:
        size += tables.n[c, k]
    order, m = np.empty(size, dtype=np.int64), len(anchors)
    order[:m] = anchors
    for k in labels:
        for x in tables.members[c, k, : tables.n[c, k]]:
            if x not in anchors:
                order[m] = x
                m += 1
    shuffle(rng, order[len(anchors) :])
    return order


@compiled
def _sort_by_confidence(setup: Setup, tables: Tables, c: int, order: Ints, anchors: int) -> None:
    """Sort the elements behind the anchors, those first that are much nearer to one anchor than to the others.

    So the first are rarely allocated wrongly, and later ones meet categories that are known well. The order depends
    on the anchors and on the set of elements only, as it must.
    """
    scratch = len(tables.n[c]) - SCRATCH
    for a in range(anchors):
        clear(setup, tables, c, scratch + a)
        push(setup, tables, c, scratch + a, order[a])
    doubt = np.empty(len(order) - anchors)
    for p in range(anchors, len(order)):
        best = second = np.inf
        for a in range(anchors):
            log_s = log_factor(setup, tables, c, scratch + a, order[p], tables.work[0])
            log_weight = log_predictive(setup, tables, c, scratch + a, log_s)
            if -log_weight < best:
                best, second = -log_weight, best
            elif -log_weight < second:
                second = -log_weight
        doubt[p - anchors] = best - second
    order[anchors:] = order[anchors:][np.argsort(doubt)]


@lean
def _allocate(
    rng: np.random.Generator,
    setup: Setup,
    tables: Tables,
    c: int,
    order: Ints,
    anchors: int,
    together: bool,
    labels: Ints,
    forced: bool,
) -> float:
    """Fill scratch categories with the elements in order, the anchors first; returns log (p/q) of the path.

    Args:
        rng: The fit's generator.
        setup: The problem.
        tables: The state.
        c: The channel.
        order: The elements.
        anchors: How many of them are anchors; each goes to a category of its own, but
        together: whether the first two share one.
        labels: One per category to fill; those of the present ones, if forced.
        forced: Whether elements follow the present z.
    """
    ways, scratch = len(labels), len(tables.n[c]) - SCRATCH
    for way in range(ways):
        clear(setup, tables, c, scratch + way)
    total = 0.0
    log_s0 = log_s1 = log_s2 = 0.0
    for p in range(len(order)):
        x = order[p]
        d = setup.owner[c, x]
        only = -1
        if p < anchors:
            only = p - 1 if together and p > 0 else p
        elif forced:
            for way in range(ways):
                if labels[way] == tables.z[c, x]:
                    only = way
        w0 = w1 = w2 = -np.inf
        for way in range(ways):
            if p < anchors and way != only:
                continue
            k = scratch + way
            log_s = log_factor(setup, tables, c, k, x, tables.work[2 + way])
            weight = setup.log_n[c, tables.n[c, k]] + setup.beta * log_predictive(setup, tables, c, k, log_s)
            if d >= 0:
                weight += log_words(setup, tables, c, d, k)
            if way == 0:
                log_s0, w0 = log_s, weight
            elif way == 1:
                log_s1, w1 = log_s, weight
            else:
                log_s2, w2 = log_s, weight
        top = max(w0, w1, w2)
        e0, e1, e2 = math.exp(w0 - top), math.exp(w1 - top), math.exp(w2 - top)
        total += top + math.log(e0 + e1 + e2)
        way = only
        if way < 0:
            u = rng.random() * (e0 + e1 + e2)
            way = 0 if u < e0 else 1 if u < e0 + e1 or ways == 2 else 2
        log_s = log_s0 if way == 0 else log_s1 if way == 1 else log_s2
        append(setup, tables, c, scratch + way, x, log_s, tables.work[2 + way])
        if d >= 0:
            count_words(setup, tables, c, d, scratch + way, 1)
    return float(total)


@lean
def _adopt(setup: Setup, tables: Tables, c: int, scratch: int, k: int) -> None:
    """Make category k what a scratch category is."""
    copy_category(setup, tables, c, scratch, k)
    for p in range(tables.n[c, k]):
        i = tables.members[c, k, p]
        tables.place[c, i], tables.z[c, i] = p, k
