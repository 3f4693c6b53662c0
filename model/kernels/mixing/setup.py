"""What the kernels know: a problem as flat arrays, and the tables of a state that follow its changes.

Arrays of all channels are padded to the largest, so that compiled code serves any number of channels. Features are in
units in which m0 = 0 and V0 = I. With n points S in a category,

    |V_n| = κ0 / κ_n · |C_S|,   C = I + X Xᵀ + 1 1ᵀ / κ0,

so that log p(X_S) = f[n] − (ν0 + n) / 2 · log |C_S|, and a further point multiplies |C_S| by a factor s. A category
is a triangular factor: of V_n (dim × dim), or of C_S (n × n), cheaper where there are fewer points than dimensions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from model.data import Flags, Floats, Ints
from model.frame_paths import Paths
from model.state import Partition

Hashes = NDArray[np.uint64]

# A set of elements that no category is.
NEVER = np.uint64(np.iinfo(np.uint64).max)
# Words of a sentence whose frames are drawn together where the prior of the frames factorises.
MOST_JOINT_WORDS = 6
# Channels that are permuted together, at most.
MOST_PERMUTED = 4
# Categories beyond the K of each channel, in which proposals are built.
SCRATCH = 3


class Setup(NamedTuple):
    """A problem; C channels, N elements of the largest, K categories of the largest.

    Attributes:
        size: (C,) number of elements.
        categories: (C,) K of each channel.
        dim: (C,) dimensions.
        by_points: (C,) whether categories are factors of C_S rather than of V_n.
        features: (C, N, dim) (x − m0) / √V0.
        products: (C, N, N) the matrix C, where categories are factors of it.
        kappa: (C,) κ0.
        nu: (C,) ν0.
        density: (C, N + 1) f[n].
        speaker: (C, D) the element that each sentence is about.
        owner: (C, N) the trial whose speaker an element is, −1 for a silent one.
        words: (C + 1, T) index into the vocabulary; the last row, as below, is of ∅, no channel.
        bounds: (D + 1,) the words of trial d are bounds[d] to bounds[d + 1] − 1.
        trials_of_word: (W + 1,) and
        word_trials: where word w occurs: trials word_trials[trials_of_word[w]:trials_of_word[w + 1]].
        framed: Whether words have frames; else each channel explains all words.
        most: Words of a sentence that a channel may explain.
        joint: Words of a sentence whose frames are drawn together.
        none: Whether words may be of no channel.
        log_named: Log prior of a frame by its words and those with a channel, where it hangs on nothing else.
        along: Whether frames are drawn along paths.
        paths: The states of frames; of use where frames are drawn along them.
        orders: (orders, channels) all orders of the channels that are permuted together, the first the identity.
        log_n: (C, …) log(n + α/K).
        log_c: (C + 1, …) log(n + γ).
        log_t: (C + 1, …) log(n + Wγ).
        mass_n: (C, …) log Γ(n + α/K) / Γ(α/K).
        mass_c: (C + 1, …) log Γ(n + γ) / Γ(γ).
        mass_t: (C + 1, …) log Γ(n + Wγ) / Γ(Wγ).
        beta: The power to which the densities of the features are raised, 1 for the posterior.
        key: (C, N) a random number of each element, by which sets of elements are told apart.
        clusters: (C,) clusters per tree of the elements; 0 where there is no tree.
        leaves: (C, trees, N) the elements in the order of the leaves of each tree.
        spans: (C, trees, N, 2) each cluster, the largest first: the leaves from the first to before the second.
    """

    size: Ints
    categories: Ints
    dim: Ints
    by_points: Flags
    features: Floats
    products: Floats
    kappa: Floats
    nu: Floats
    density: Floats
    speaker: Ints
    owner: Ints
    words: Ints
    bounds: Ints
    trials_of_word: Ints
    word_trials: Ints
    framed: bool
    most: int
    joint: int
    none: bool
    log_named: Floats
    along: bool
    paths: Paths
    orders: Ints
    log_n: Floats
    log_c: Floats
    log_t: Floats
    mass_n: Floats
    mass_c: Floats
    mass_t: Floats
    beta: float
    key: Hashes
    clusters: Ints
    leaves: Ints
    spans: Ints


class Tables(NamedTuple):
    """A state and what follows from it; changed in place. K here includes the scratch categories.

    Attributes:
        z: (C, N) category of each element, −1 for one that is taken out.
        F: (T,) channel of each word, C for none.
        n: (C, K) elements per category.
        members: (C, K, N) the elements of each category, in the order of the factor.
        place: (C, N) where an element stands among the members.
        upper: (C, K, M, M) U with Uᵀ U = C_S or V_n.
        mean: (C, K, dim) m_n, where V_n is factored.
        log_det: (C, K) log |C_S|.
        identity: (C, K) exclusive or of the keys of the members: which set of elements it is.
        words: (C + 1, K, W) how often the category explains each word; of ∅ only the first.
        total: (C + 1, K) sums of `words`.
        orders: (S,) how many sentences end in each state of the paths.
        predicted: (C, K, N) log p(x_i | category k) as last computed, and
        predicted_for: (C, K, N) for which set of members.
        left_out: (C, N) log p(x_i | the others of its category) as last computed, and
        left_out_of: (C, N) for which set of members.
        work: (2 + SCRATCH, M) working space of triangular solves.
    """

    z: Ints
    F: Ints
    n: Ints
    members: Ints
    place: Ints
    upper: Floats
    mean: Floats
    log_det: Floats
    identity: Hashes
    words: Ints
    total: Ints
    orders: Ints
    predicted: Floats
    predicted_for: Hashes
    left_out: Floats
    left_out_of: Hashes
    work: Floats


def tables_of(setup: Setup, W: int, state: Partition) -> Tables:
    """The tables of a state, not yet filled; see `gaussians.fill`."""
    C, N = setup.owner.shape
    K = int(setup.categories.max()) + SCRATCH
    M = int(np.where(setup.by_points, setup.size, setup.dim).max())
    z = np.full((C, N), -1, dtype=np.int64)
    for c, own in enumerate(state.z):
        z[c, : len(own)] = own
    return Tables(
        z=z,
        F=state.F.copy(),
        n=np.zeros((C, K), dtype=np.int64),
        members=np.zeros((C, K, N), dtype=np.int64),
        place=np.zeros((C, N), dtype=np.int64),
        upper=np.zeros((C, K, M, M)),
        mean=np.zeros((C, K, setup.features.shape[2])),
        log_det=np.zeros((C, K)),
        identity=np.zeros((C, K), dtype=np.uint64),
        words=np.zeros((C + 1, K, W), dtype=np.int64),
        total=np.zeros((C + 1, K), dtype=np.int64),
        orders=np.zeros(len(setup.paths.size), dtype=np.int64),
        predicted=np.zeros((C, K, N)),
        predicted_for=np.full((C, K, N), NEVER),
        left_out=np.zeros((C, N)),
        left_out_of=np.full((C, N), NEVER),
        work=np.zeros((2 + SCRATCH, M)),
    )
