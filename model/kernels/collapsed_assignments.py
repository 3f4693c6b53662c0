"""The collapsed sampler's conditional of z: one element given all others, π, φ and θ integrated out.

The counts and Gaussians of the others are kept while a sweep goes on: an element is taken out, weighed against each
category, and put into the one that is drawn (docs/model.md, The samplers).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from model.compiled import compiled
from model.data import Flags, Floats, Ints
from model.distributions.dirichlet import draw_index
from model.distributions.gaussians import GaussianInverseWishart, fit_category, gaussian_posterior
from model.distributions.predictive import (
    add_point,
    change_count,
    remove_point,
    student_constant,
    student_log_density,
)
from model.kernels.words import word_counts
from model.prior import GaussianPrior
from model.problem import Problem


class Elements(NamedTuple):
    """One channel's data and hyperparameters.

    Attributes:
        features: (N, dim).
        words: (T,) index into the vocabulary of each word.
        order: (T,) the words in the order of the elements that utter them.
        bounds: (N + 1,) the words of element i are order[bounds[i]] to order[bounds[i + 1] − 1].
        explained: (T,) whether the channel explains each word.
        gaussian: Prior of the Gaussians.
        weight: α/K.
        gamma: γ.
    """

    features: Floats
    words: Ints
    order: Ints
    bounds: Ints
    explained: Flags
    gaussian: GaussianPrior
    weight: float
    gamma: float


class Statistics(NamedTuple):
    """What the categories of one channel know.

    Attributes:
        posterior: Posterior of the Gaussians.
        constant: (K,) log of the constant of each predictive Student distribution.
        words: (K, W) how often each category was the reason of each word.
        word_totals: (K,) sums of `words` over the vocabulary.
        empty: (N,) log density of each element under a category without elements.
    """

    posterior: GaussianInverseWishart
    constant: Floats
    words: Floats
    word_totals: Floats
    empty: Floats


def sweep_assignments(
    rng: np.random.Generator, problem: Problem, c: int, z: Ints, F: Ints, temperature: float
) -> Ints:
    """Draw z of channel c, one element after the other; `temperature` (1 for the posterior) divides log weights."""
    return _swept_assignments(rng, elements_of(problem, c, F), word_counts(problem, c, z, F), z, temperature)


def elements_of(problem: Problem, c: int, F: Ints) -> Elements:
    """What the kernels know of channel c, given the frames F (T,)."""
    trials, prior = problem.trials, problem.priors[c]
    return Elements(
        trials.channels[c].features,
        trials.words[c],
        *trials.words_by_element[c],
        problem.explained(F, c),
        problem.gaussians[c],
        prior.concentration / prior.categories,
        prior.word_concentration,
    )


@compiled
def _swept_assignments(
    rng: np.random.Generator, elements: Elements, counts: Floats, z: Ints, temperature: float
) -> Ints:
    """Draw z (N,) from categories z and their word counts (K, W), see `sweep`."""
    statistics, z = channel_statistics(elements, counts, z), z.copy()
    sweep(rng, elements, statistics, z, temperature)
    return z


@compiled
def sweep(rng: np.random.Generator, elements: Elements, statistics: Statistics, z: Ints, temperature: float) -> None:
    """Draw the category of each element in turn; z and the statistics change in place."""
    posterior, dim = statistics.posterior, elements.features.shape[1]
    offset, mean, upper = np.empty(dim), np.empty(dim), np.empty((dim, dim))
    for i in range(len(z)):
        old, own_words = z[i], words_of_element(elements, i)
        mean[:], upper[:], constant = posterior.mean[old], posterior.upper[old], statistics.constant[old]
        z[i] = -1
        remove_element(elements, statistics, z, i, old)
        count_words(statistics, old, own_words, -1.0)
        log_weights = category_log_weights(elements, statistics, i, own_words, offset)
        new = draw_index(rng, log_weights / temperature)
        z[i] = new
        count_words(statistics, new, own_words, 1.0)
        if new == old:  # Exactly as it was, and cheaper than an update.
            posterior.mean[old], posterior.upper[old], statistics.constant[old] = mean, upper, constant
            change_count(posterior, old, 1.0)
        else:
            add_element(elements, statistics, i, new)


@compiled
def channel_statistics(elements: Elements, counts: Floats, z: Ints) -> Statistics:
    """What the categories know, computed from all elements (N,) and word counts (K, W)."""
    features, prior = elements.features, elements.gaussian
    posterior = gaussian_posterior(features, z, len(counts), prior)
    # One empty category; numbers written as literals would compile the callees once more.
    nothing = gaussian_posterior(features[:0], z[:0], min(1, len(counts)), prior)
    only = len(nothing.mean) - 1
    constant, empty, offset = np.empty(len(counts)), np.empty(len(features)), np.empty(features.shape[1])
    for k in range(len(constant)):
        constant[k] = student_constant(posterior, k)
    constant_of_nothing = student_constant(nothing, only)
    for i in range(len(features)):
        empty[i] = student_log_density(nothing, only, constant_of_nothing, features[i], offset)
    return Statistics(posterior, constant, counts.copy(), counts.sum(axis=1), empty)


@compiled
def category_log_weights(
    elements: Elements, statistics: Statistics, i: int, own_words: Ints, offset: Floats
) -> Floats:
    """(K,) unnormalised log p(z_i = k | …) of element i, from statistics without it.

    Args:
        elements: The channel.
        statistics: Of all elements but i, and all words but its own.
        i: The element.
        own_words: The words that point at the element; counts grow from one to the next.
        offset: (dim,) working space.
    """
    posterior = statistics.posterior
    K, W = statistics.words.shape
    result = np.empty(K)
    for k in range(K):
        if posterior.counts[k] == 0.0:
            emission = statistics.empty[i]
        else:
            emission = student_log_density(posterior, k, statistics.constant[k], elements.features[i], offset)
        result[k] = math.log(posterior.counts[k] + elements.weight) + emission
        for n in range(len(own_words)):
            count, total = statistics.words[k, own_words[n]] + elements.gamma, statistics.word_totals[k] + n
            for earlier in range(n):
                if own_words[earlier] == own_words[n]:
                    count += 1.0
            result[k] += math.log(count / (total + W * elements.gamma))
    return result


@compiled
def remove_element(elements: Elements, statistics: Statistics, z: Ints, i: int, k: int) -> None:
    """Take the features of element i, which z no longer gives to category k, out of that category."""
    if not remove_point(statistics.posterior, k, elements.features[i]):
        fit_category(statistics.posterior, k, elements.gaussian, elements.features, z)
    statistics.constant[k] = student_constant(statistics.posterior, k)


@compiled
def add_element(elements: Elements, statistics: Statistics, i: int, k: int) -> None:
    """Put the features of element i into category k."""
    add_point(statistics.posterior, k, elements.features[i])
    statistics.constant[k] = student_constant(statistics.posterior, k)


@compiled
def words_of_element(elements: Elements, i: int) -> Ints:
    """The words that point at element i: of all that it may utter, those that the channel explains."""
    mine = elements.order[elements.bounds[i] : elements.bounds[i + 1]]
    result = np.empty(len(mine), dtype=np.int64)
    size = 0
    for t in mine:
        if elements.explained[t]:
            result[size] = elements.words[t]
            size += 1
    return result[:size]


@compiled
def count_words(statistics: Statistics, k: int, own_words: Ints, change: float) -> None:
    """Add `change` for each of an element's words to the word counts of category k."""
    for word in own_words:
        statistics.words[k, word] += change
        statistics.word_totals[k] += change
