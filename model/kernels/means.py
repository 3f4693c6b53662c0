"""Posterior means of π, φ and θ given z and F, so that all samplers can end with the same parameters."""

from __future__ import annotations

import numpy as np

from model.data import Floats, Ints
from model.distributions.gaussians import gaussian_posterior
from model.frame_paths import log_mean_orders
from model.kernels.frame_paths import count_states
from model.kernels.words import none_counts, weighted_word_counts
from model.problem import Problem
from model.state import Partition, State


def posterior_means(problem: Problem, state: Partition, marginals: Floats | None = None) -> State:
    """The state with π, φ and θ at their posterior means.

    Where the mean of Σ does not exist, with ν_n ≤ dim + 1 (an empty category, and ν0 ≤ dim + 1), its mode stands in.

    Args:
        problem: Data, method and hyperparameters.
        state: z and F.
        marginals: (T, sources) how much of each word each source explains where F is not certain; else as F says.
    """
    log_weights, mean, factor, log_words = [], [], [], []
    for c, (channel, prior) in enumerate(zip(problem.trials.channels, problem.priors, strict=True)):
        posterior = gaussian_posterior(channel.features, state.z[c], prior.categories, problem.gaussians[c])
        excess = posterior.degrees_of_freedom - channel.dim - 1.0
        divisor = np.where(excess > 0.0, excess, posterior.degrees_of_freedom + channel.dim + 1.0)
        explained = problem.counted(state.F, c) if marginals is None else marginals[:, c]
        counts = weighted_word_counts(problem, c, state.z[c], explained.astype(np.float64))
        log_weights.append(_log_means(posterior.counts + prior.concentration / prior.categories))
        mean.append(posterior.mean)
        factor.append(np.ascontiguousarray(posterior.upper.transpose(0, 2, 1)) / np.sqrt(divisor)[:, None, None])
        log_words.append(_log_means(prior.word_concentration + counts))
    C = len(problem.priors)
    if problem.frame_prior.has_none:
        of_none = np.equal(state.F, C).astype(np.float64) if marginals is None else marginals[:, C].copy()
        log_words.append(_log_means(problem.none_concentration + none_counts(problem, of_none)))
    log_orders = mean_orders(problem, state.F)
    return State(state.z, state.F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words), log_orders)


def mean_orders(problem: Problem, F: Ints) -> Floats:
    """(S,) log of the posterior mean of λ given F; the mean over several F (H, T). Empty where it is not learned."""
    paths = problem.paths
    if paths is None or not paths.learned:
        return np.empty(0)
    bounds = problem.trials.sentence_bounds
    counts = np.mean([count_states(paths, row, bounds) for row in np.atleast_2d(F)], axis=0)
    return log_mean_orders(paths, counts)


def _log_means(concentration: Floats) -> Floats:
    """Logarithms of the means of Dirichlet distributions along the last axis."""
    return np.asarray(np.log(concentration / concentration.sum(axis=-1, keepdims=True)))
