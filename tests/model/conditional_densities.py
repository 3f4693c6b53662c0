"""The logarithms of the conditionals that the samplers draw from: what tests hold against the joint distribution."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from model import Prior, Problem
from model.data import Floats, Ints
from model.distributions.dirichlet import dirichlet_log_density
from model.distributions.gaussian_densities import giw_log_density
from model.distributions.gaussians import gaussian_posterior
from model.kernels import collapsed_assignments as assignments
from model.kernels import collapsed_frames as frames
from model.kernels.conditionals import weights_concentration
from model.kernels.word_table import count_part, word_table
from model.kernels.words import word_counts
from model.log_space import log_sum


def weights_log_density(prior: Prior, z: Ints, log_weights: Floats) -> float:
    """Log density of π given z."""
    return dirichlet_log_density(log_weights[None, :], weights_concentration(prior, z))


def categories_log_density(problem: Problem, c: int, z: Ints, mean: Floats, factor: Floats) -> float:
    """Log density of all μ and Σ of a channel given z."""
    features = problem.trials.channels[c].features
    posterior = gaussian_posterior(features, z, problem.priors[c].categories, problem.gaussians[c])
    return float(np.sum(giw_log_density(posterior, mean, factor)))


def frames_log_probability(problem: Problem, log_weights: Floats, F: Ints) -> float:
    """Log probability of F given `words.word_log_weights`; up to a constant where sentences are drawn along paths."""
    if problem.paths is not None:
        said = log_weights[np.arange(len(F)), F].sum()
        return float(problem.frame_prior.log_probability(problem.trials, F) + said)
    allowed, total = problem.frame_prior.listed(problem.trials, 1), 0.0
    longest, bounds = allowed.frames.shape[1], problem.trials.sentence_bounds
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        for start in range(first, last, longest):
            own = np.arange(start, min(start + longest, last))
            listed = allowed.frames[allowed.bounds[len(own)] : allowed.bounds[len(own) + 1], : len(own)]
            total += log_weights[own, F[own]].sum() - log_sum(log_weights[own, listed].sum(axis=1))[0]
    return float(total)


def element_log_weights(problem: Problem, c: int, z: Ints, F: Ints, i: int) -> Floats:
    """(K,) unnormalised log p(z_i = k | …) of element i of channel c, which `sweep_assignments` draws from."""
    elements = assignments.elements_of(problem, c, F)
    statistics = assignments.channel_statistics(elements, word_counts(problem, c, z, F), z)
    z, old, own_words = z.copy(), z[i], assignments.words_of_element(elements, i)
    z[i] = -1
    assignments.remove_element(elements, statistics, z, i, old)
    assignments.count_words(statistics, old, own_words, -1.0)
    working_space = np.empty(elements.features.shape[1])
    return assignments.category_log_weights(elements, statistics, i, own_words, working_space)


def part_log_weights(problem: Problem, z: Sequence[Ints], F: Ints, start: int, length: int) -> Floats:
    """(frames,) unnormalised log p(F = f | …) for the words start to start + length − 1, as `sweep_frames` draws."""
    allowed = problem.frame_prior.listed(problem.trials, frames.MOST_JOINT_WORDS)
    words, table = problem.trials.words[0], word_table(problem, z, F)
    count_part(table, words, F, start, length, -1.0)
    log_weights = frames.grown_log_weights(table, words, start, length, allowed)
    d = int(problem.trials.word_trial[start])
    first, last = problem.trials.sentence_bounds[d : d + 2].tolist()
    frames.add_log_prior(log_weights, F, first, last, start, length, allowed)
    return log_weights
