"""A problem as the flat arrays of `model.kernels.mixing.setup`."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import permutations

import numpy as np
from scipy.special import gammaln, multigammaln

from model.compiled import compiled
from model.data import Flags, Floats
from model.frame_paths import paths_of
from model.kernels.mixing.setup import MOST_JOINT_WORDS, MOST_PERMUTED, Setup
from model.kernels.mixing.tree import with_trees
from model.prior import GaussianPrior
from model.problem import Problem

# Points of a channel up to which its categories may be factors of C, whose size grows with them.
_MOST_POINTS = 600
# The largest number of C up to which its factors keep enough digits: a point's factor s is at least 1, and the
# difference of two numbers of that size. V_n grows from deviations, which lose none.
_LARGEST_PRODUCT = 1e9


def setup_of(problem: Problem) -> Setup:
    """The arrays of a problem, for its posterior (β = 1)."""
    trials, priors, prior = problem.trials, problem.priors, problem.frame_prior
    channels, C, W, T = trials.channels, len(priors), len(trials.vocabulary), trials.words.shape[1]
    size = np.array([len(channel.features) for channel in channels])
    dim = np.array([channel.dim for channel in channels])
    N = int(size.max())
    # The factor of C_S pays while a category has fewer points than dimensions; it never is larger than all points.
    by_points = (size <= 3 * dim) & (size <= _MOST_POINTS)
    features, density = np.zeros((C, N, int(dim.max()))), np.zeros((C, N + 1))
    owner = np.full((C, N), -1, dtype=np.int64)
    for c, (channel, own) in enumerate(zip(channels, problem.gaussians, strict=True)):
        features[c, : size[c], : dim[c]] = (channel.features - own.mean) / math.sqrt(own.scale)
        owner[c, channel.speaker] = np.arange(trials.count)
        by_points[c] &= 1.0 / priors[c].mean_precisions[0] + np.square(features[c]).sum(1).max() <= _LARGEST_PRODUCT
    most_points = int(np.where(by_points, size, 1).max())
    products = np.zeros((C, most_points, most_points))
    weight = np.array([own.concentration / own.categories for own in priors])[:, None]
    gamma = np.array([own.word_concentration for own in priors] + [problem.none_concentration])[:, None]
    paths = problem.paths
    along = paths is not None and paths.once
    count = np.arange(max(N, T) + 2.0)
    longest = max(1, trials.longest_sentence)
    by_word = [np.unique(trials.word_trial[trials.words[0] == w]) for w in range(W)]
    vocabulary = max(W, 1)
    setup = Setup(
        size=size,
        categories=np.array([own.categories for own in priors]),
        dim=dim,
        by_points=by_points,
        features=features,
        products=products,
        kappa=np.full(C, np.nan),
        nu=np.array([own.degrees_of_freedom for own in problem.gaussians]),
        density=density,
        speaker=np.stack([channel.speaker for channel in channels]),
        owner=owner,
        words=np.concatenate([trials.words, trials.words[:1]]),
        bounds=trials.sentence_bounds,
        trials_of_word=np.cumsum([0, *map(len, by_word)]).astype(np.int64),
        word_trials=np.concatenate([np.empty(0, dtype=np.int64), *by_word]),
        framed=prior.has_frames,
        most=int(min(longest, prior.most_per_channel)),
        joint=prior.joint_words(longest, MOST_JOINT_WORDS),
        none=prior.has_none,
        log_named=prior.log_named(C, longest),
        along=along,
        paths=paths if along and paths is not None else paths_of(0, 0, False, False),
        orders=np.array(list(permutations(range(min(C, MOST_PERMUTED))))),
        log_n=np.log(count + weight),
        log_c=np.log(count + gamma),
        log_t=np.log(count + vocabulary * gamma),
        mass_n=gammaln(count + weight) - gammaln(weight),
        mass_c=gammaln(count + gamma) - gammaln(gamma),
        mass_t=gammaln(count + vocabulary * gamma) - gammaln(vocabulary * gamma),
        beta=1.0,
        # Not a draw of the chain: other keys give the same chain.
        key=np.random.default_rng(0).integers(1, 2**64, size=(C, N), dtype=np.uint64, endpoint=False),
        clusters=np.zeros(C, dtype=np.int64),
        leaves=np.empty((C, 0, N), dtype=np.int64),
        spans=np.empty((C, 0, 2 * N, 2), dtype=np.int64),
    )
    relearn(setup, problem)
    return with_trees(setup)


def relearn(setup: Setup, problem: Problem) -> Flags:
    """Change a setup to the κ0 that its problem has now; tells of which channels (C,) κ0 is another."""
    kappa = np.array(problem.mean_precision)
    changed: Flags = kappa != setup.kappa
    for c in np.flatnonzero(changed).tolist():
        own, size = problem.gaussians[c], int(setup.size[c])
        setup.kappa[c] = kappa[c]
        setup.density[c] = _log_densities(int(setup.dim[c]), own, setup.density.shape[1] - 1)
        if setup.by_points[c]:
            _fill_products(setup.products[c], setup.features[c, :size], own.mean_precision)
    return changed


def _log_densities(dim: int, prior: GaussianPrior, N: int) -> Floats:
    """(N + 1,) f[n], with log p(X_S) = f[n] − (ν0 + n) / 2 · log |C_S| for n points S."""
    n = np.arange(N + 1)
    gammas = _log_gammas(dim, prior.degrees_of_freedom, N)
    precision = np.log(prior.mean_precision / (prior.mean_precision + n))
    units = -0.5 * dim * n * (math.log(prior.scale) + math.log(math.pi))
    return np.asarray(gammas + 0.5 * dim * precision + units - 0.5 * (prior.degrees_of_freedom + n) * precision)


@lru_cache(maxsize=16)
def _log_gammas(dim: int, nu: float, N: int) -> Floats:
    """(N + 1,) log Γ_dim((ν0 + n) / 2) / Γ_dim(ν0 / 2), which is the same for every κ0."""
    return np.array([multigammaln((nu + m) / 2.0, dim) for m in range(N + 1)]) - multigammaln(nu / 2.0, dim)


@compiled
def _fill_products(products: Floats, points: Floats, kappa: float) -> None:
    """Set C = I + X Xᵀ + 1 1ᵀ / κ0 of points (N, dim); sums in a fixed order, unlike a library's product."""
    for i in range(len(points)):
        for j in range(i + 1):
            total = 1.0 / kappa
            for m in range(points.shape[1]):
                total += points[i, m] * points[j, m]
            products[i, j] = products[j, i] = total
        products[i, i] += 1.0
