"""Word counts of the categories, and what a state's tables say: filling them, masses, and the log joint."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled, inlined, lean
from model.data import Floats
from model.kernels.frame_paths import last_state
from model.kernels.mixing.gaussians import attach, clear_points, detach, log_density, push
from model.kernels.mixing.setup import NEVER, Setup, Tables


@compiled
def fill(setup: Setup, tables: Tables) -> None:
    """Compute all tables from z and F."""
    C = len(setup.size)
    for c in range(C):
        fill_channel(setup, tables, c)
    tables.words[C], tables.total[C], tables.orders[:] = 0, 0, 0
    for d in range(setup.speaker.shape[1]):
        count_frame(setup, tables, d, 1)


@compiled
def fill_channel(setup: Setup, tables: Tables, c: int) -> None:
    """Compute the tables of a channel from z and F; densities that were kept for another κ0 count no more."""
    tables.predicted_for[c], tables.left_out_of[c] = NEVER, NEVER
    for k in range(len(tables.n[c])):
        clear(setup, tables, c, k)
    for i in range(setup.size[c]):
        attach(setup, tables, c, tables.z[c, i], i)
    for d in range(setup.speaker.shape[1]):
        count_words(setup, tables, c, d, tables.z[c, setup.speaker[c, d]], 1)


@lean
def clear(setup: Setup, tables: Tables, c: int, k: int) -> None:
    """Make category k empty, without a look at z."""
    clear_points(setup, tables, c, k)
    tables.total[c, k] = 0
    for w in range(tables.words.shape[2]):
        tables.words[c, k, w] = 0


@lean
def copy_category(setup: Setup, tables: Tables, c: int, k: int, other: int) -> None:
    """Make another category what category k is, without a look at z."""
    n, size = tables.n[c, k], setup.dim[c]
    if setup.by_points[c]:
        size = n
    tables.n[c, other], tables.log_det[c, other], tables.total[c, other] = n, tables.log_det[c, k], tables.total[c, k]
    tables.identity[c, other] = tables.identity[c, k]
    for w in range(tables.words.shape[2]):
        tables.words[c, other, w] = tables.words[c, k, w]
    for j in range(setup.dim[c]):
        tables.mean[c, other, j] = tables.mean[c, k, j]
    for p in range(n):
        tables.members[c, other, p] = tables.members[c, k, p]
    for a in range(size):
        for b in range(a, size):
            tables.upper[c, other, a, b] = tables.upper[c, k, a, b]


@inlined
def count_words(setup: Setup, tables: Tables, c: int, d: int, k: int, change: int) -> None:
    """Add `change` for each word of trial d that channel c explains to category k."""
    for t in range(setup.bounds[d], setup.bounds[d + 1]):
        if not setup.framed or tables.F[t] == c:
            tables.words[c, k, setup.words[c, t]] += change
            tables.total[c, k] += change


@lean
def count_frame(setup: Setup, tables: Tables, d: int, change: int) -> None:
    """Add `change` for what trial d's frame has beside the channels' words: words of no channel, and its state."""
    first, last = setup.bounds[d], setup.bounds[d + 1]
    if setup.none:
        count_words(setup, tables, len(setup.size), d, 0, change)
    if setup.along:
        tables.orders[last_state(setup.paths, tables.F, first, last)] += change


@inlined
def log_words(setup: Setup, tables: Tables, c: int, d: int, k: int) -> float:
    """Log p(words of trial d that channel c explains | category k), which does not count them; counts grow within."""
    result, shared, first = 0.0, 0, setup.bounds[d]
    for t in range(first, setup.bounds[d + 1]):
        if not setup.framed or tables.F[t] == c:
            word, equal = setup.words[c, t], 0
            for e in range(first, t):
                if setup.words[c, e] == word and (not setup.framed or tables.F[e] == c):
                    equal += 1
            result += setup.log_c[c, tables.words[c, k, word] + equal] - setup.log_t[c, tables.total[c, k] + shared]
            shared += 1
    return result


@inlined
def log_prior_and_density(setup: Setup, tables: Tables, c: int, k: int, i: int) -> float:
    """Log of (n_k + α/K) · p(x_i | k)^β, without i in the counts."""
    others = tables.n[c, k] - (1 if tables.z[c, i] == k else 0)
    return float(setup.log_n[c, others] + setup.beta * log_density(setup, tables, c, k, i))


@inlined
def element_log_weight(setup: Setup, tables: Tables, c: int, k: int, i: int) -> float:
    """Log of (n_k + α/K) · p(x_i | k)^β · p(its words | k), without i and its words in the counts."""
    result = log_prior_and_density(setup, tables, c, k, i)
    if setup.owner[c, i] >= 0:
        result += log_words(setup, tables, c, setup.owner[c, i], k)
    return float(result)


@compiled
def element_log_weights(setup: Setup, tables: Tables, c: int, i: int) -> Floats:
    """(K,) `element_log_weight` of every category."""
    log_weights = np.empty(setup.categories[c])
    for k in range(len(log_weights)):
        log_weights[k] = element_log_weight(setup, tables, c, k, i)
    return log_weights


@lean
def join(setup: Setup, tables: Tables, c: int, k: int, i: int) -> None:
    """Put element i, which is in no category, and its words into category k."""
    attach(setup, tables, c, k, i)
    if setup.owner[c, i] >= 0:
        count_words(setup, tables, c, setup.owner[c, i], k, 1)


@lean
def leave(setup: Setup, tables: Tables, c: int, i: int) -> None:
    """Take element i and its words out of its category."""
    if setup.owner[c, i] >= 0:
        count_words(setup, tables, c, setup.owner[c, i], tables.z[c, i], -1)
    detach(setup, tables, c, i)


@inlined
def put(setup: Setup, tables: Tables, c: int, k: int, i: int) -> None:
    """Put element i and its words into a scratch category."""
    push(setup, tables, c, k, i)
    if setup.owner[c, i] >= 0:
        count_words(setup, tables, c, setup.owner[c, i], k, 1)


@lean
def category_log_mass(setup: Setup, tables: Tables, c: int, k: int) -> float:
    """Log m(k), the whole weight of a category: its size, its points and its words."""
    n = tables.n[c, k]
    points = setup.density[c, n] - 0.5 * (setup.nu[c] + n) * tables.log_det[c, k]
    return float(setup.mass_n[c, n] + setup.beta * points + _words_log_mass(setup, tables, c, k))


@inlined
def _words_log_mass(setup: Setup, tables: Tables, c: int, k: int) -> float:
    result = 0.0
    if tables.total[c, k] > 0:
        result -= setup.mass_t[c, tables.total[c, k]]
        for count in tables.words[c, k]:
            if count > 0:
                result += setup.mass_c[c, count]
    return result


@lean
def count_empty(setup: Setup, tables: Tables, c: int) -> int:
    """How many categories of channel c are empty."""
    empty = 0
    for k in range(setup.categories[c]):
        empty += tables.n[c, k] == 0
    return empty


@lean
def draw_empty(rng: np.random.Generator, setup: Setup, tables: Tables, c: int, empty: int) -> int:
    """One of the empty categories, all alike."""
    which = int(rng.random() * empty)
    for k in range(setup.categories[c]):
        if tables.n[c, k] == 0:
            if which == 0:
                return k
            which -= 1
    return -1


@compiled
def log_masses(setup: Setup, tables: Tables) -> float:
    """Σ log m(k) over all categories, and words of none: log p(X, w, z, F) but for `model.joint.log_constant`."""
    total = 0.0
    for c in range(len(setup.size)):
        for k in range(setup.categories[c]):
            total += category_log_mass(setup, tables, c, k)
    if setup.none:
        total += _words_log_mass(setup, tables, len(setup.size), 0)
    return total
