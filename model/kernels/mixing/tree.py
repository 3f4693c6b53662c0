"""Trees over the elements of a channel, whose nodes are clusters that `clusters` takes for one.

Bayesian hierarchical clustering (Heller and Ghahramani 2005), greedy: every element is a category of its own, and
the two whose union gains most weight, log m(k ∪ l) − log m(k) − log m(l) without words, are joined until one is left.
So nodes are what the model itself would take for one. To each gain but those of the first tree comes a Gumbel
variate, so that the trees differ where the model hardly prefers one to the other. Trees hang on the features and κ0
alone, not on a state.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Flags, Floats, Ints
from model.kernels.mixing.counts import category_log_mass, clear, copy_category
from model.kernels.mixing.gaussians import push
from model.kernels.mixing.setup import SCRATCH, Setup, Tables, tables_of
from model.state import Partition

# Scales of the Gumbel variates, one per tree, in nats.
_NOISE = (0.0, 1.0, 3.0, 6.0)
# Elements up to which a channel has trees: memory grows with their cube.
_MOST_ELEMENTS = 200


def with_trees(setup: Setup) -> Setup:
    """A setup with the trees of its channels; those of many elements have none."""
    C, N = setup.owner.shape
    clusters = np.zeros(C, dtype=np.int64)
    leaves = np.zeros((C, len(_NOISE), N), dtype=np.int64)
    spans = np.zeros((C, len(_NOISE), 2 * N, 2), dtype=np.int64)
    for c, size in enumerate(setup.size.tolist()):
        if not 2 <= size <= _MOST_ELEMENTS:
            continue
        clusters[c] = 2 * size - 1
        alone = _features_of(setup, c)
        tables = tables_of(alone, 0, Partition((np.arange(size),), np.empty(0, dtype=np.int64)))
        # Not a draw of the chain: every chain of a problem has the same trees.
        rng = np.random.default_rng(c)
        for tree, noise in enumerate(_NOISE):
            joins = _agglomerate(rng, alone, tables, 0, noise)
            leaves[c, tree, :size], spans[c, tree, : clusters[c]] = _spans(joins)
    return setup._replace(clusters=clusters, leaves=leaves, spans=spans)


def _features_of(setup: Setup, c: int) -> Setup:
    """The setup of one channel without words, with as many categories as elements."""
    size, dim = setup.size[c], setup.dim[c]
    points, own = size if setup.by_points[c] else 1, slice(c, c + 1)
    kept = ("size", "dim", "by_points", "kappa", "nu", "density", "mass_n", "key")
    return setup._replace(
        **{name: getattr(setup, name)[own] for name in kept},
        categories=setup.size[own],
        features=setup.features[own, :size, :dim],
        products=setup.products[own, :points, :points],
        owner=np.full((1, size), -1, dtype=np.int64),
        beta=1.0,
    )


@compiled
def _agglomerate(rng: np.random.Generator, setup: Setup, tables: Tables, c: int, noise: float) -> Ints:
    """(N − 1, 2) which nodes are joined, in turn: 0 to N − 1 are the elements, N + m is what join m makes."""
    N = setup.size[c]
    joins, node = np.empty((N - 1, 2), dtype=np.int64), np.arange(N)
    mass, gain, alive = np.empty(N), np.full((N, N), -np.inf), np.ones(N, dtype=np.bool_)
    for i in range(N):
        clear(setup, tables, c, i)
        push(setup, tables, c, i, i)
        mass[i] = category_log_mass(setup, tables, c, i)
    for i in range(N):
        _weigh_unions(rng, setup, tables, c, i, alive[:i], mass, gain, noise)
    for m in range(N - 1):
        k, other = divmod(np.argmax(gain), N)
        if tables.n[c, other] > tables.n[c, k]:
            k, other = other, k
        for p in range(tables.n[c, other]):
            push(setup, tables, c, k, tables.members[c, other, p])
        joins[m] = node[k], node[other]
        alive[other] = False
        gain[other] = -np.inf
        gain[:, other] = -np.inf
        node[k], mass[k] = N + m, category_log_mass(setup, tables, c, k)
        _weigh_unions(rng, setup, tables, c, k, alive, mass, gain, noise)
    return joins


@compiled
def _weigh_unions(
    rng: np.random.Generator,
    setup: Setup,
    tables: Tables,
    c: int,
    k: int,
    alive: Flags,
    mass: Floats,
    gain: Floats,
    noise: float,
) -> None:
    """Set the gains of the unions of category k with those alive."""
    scratch = setup.size[c] + SCRATCH - 1
    for other in range(len(alive)):
        if other == k or not alive[other]:
            continue
        large, small = (k, other) if tables.n[c, k] >= tables.n[c, other] else (other, k)
        copy_category(setup, tables, c, large, scratch)
        for p in range(tables.n[c, small]):
            push(setup, tables, c, scratch, tables.members[c, small, p])
        value = category_log_mass(setup, tables, c, scratch) - mass[k] - mass[other]
        if noise > 0.0:
            value -= noise * math.log(-math.log(1.0 - rng.random()))
        gain[max(k, other), min(k, other)] = value


def _spans(joins: Ints) -> tuple[Ints, Ints]:
    """(N,) the elements in the order of the leaves, and (2N − 1, 2) the spans of the nodes, from the top."""
    N = len(joins) + 1
    nodes = [[i] for i in range(N)]
    for k, other in joins.tolist():
        nodes.append(nodes[k] + nodes[other])
    place = np.argsort(nodes[-1])
    first = np.array([min(place[node]) for node in nodes])
    spans = np.stack([first, first + [len(node) for node in nodes]], axis=1)
    return np.array(nodes[-1]), spans[::-1]
