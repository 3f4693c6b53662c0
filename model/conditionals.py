"""The conditional distributions of the blocked Gibbs sampler, equations (11) to (25).

Each block has one draw and one log function. The log functions are what the tests hold
against the joint distribution: a conditional is right if it is proportional to the joint.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from model.data import Channel, Floats, Ints, Prior, Trials
from model.distributions import (
    dirichlet_log_density,
    draw_categorical,
    draw_gaussians,
    draw_log_dirichlet,
    gaussian_log_density,
    gaussian_posterior,
    giw_log_density,
    log_sum,
)
from model.frames import Rule, distinct_frames
from model.state import Settings


def explained_words(rule: Rule, F: Ints, channel: int, count: int) -> NDArray[np.bool_]:
    """(T,) whether a channel explains each word: by its frame, or always where there is no frame."""
    return np.ones(count, dtype=bool) if rule == "every" else F == channel


# z^x: equations (21) to (24) of the paper's section 3.3


def assignment_log_weights(
    trials: Trials,
    index: int,
    log_weights: Floats,
    mean: Floats,
    factor: Floats,
    log_words: Floats,
    explained: NDArray[np.bool_],
) -> Floats:
    """(N, K) unnormalised log p(z = k | …) of one channel's elements: π_k N(x | μ_k, Σ_k) ∏ θ_{k,w}."""
    channel = trials.channels[index]
    result = np.asarray(log_weights) + gaussian_log_density(channel.features, mean, factor)
    speaker = channel.speaker[trials.word_trial[explained]]
    np.add.at(result, speaker, log_words[:, trials.words[index, explained]].T)
    return np.asarray(result, dtype=np.float64)


def draw_assignments(rng: np.random.Generator, log_weights: Floats) -> Ints:
    """Draw z from the rows of `assignment_log_weights`."""
    return draw_categorical(rng, log_weights)


# π^x


def weights_concentration(prior: Prior, z: Ints) -> Floats:
    """(K,) parameters of π | z ~ Dir(α/K + n_1, …, α/K + n_K)."""
    K = prior.categories
    return np.asarray(prior.concentration / K + np.bincount(z, minlength=K), dtype=np.float64)


def draw_weights(rng: np.random.Generator, prior: Prior, z: Ints) -> Floats:
    """Draw log π given z."""
    return draw_log_dirichlet(rng, weights_concentration(prior, z))


def weights_log_density(prior: Prior, z: Ints, log_weights: Floats) -> float:
    """Log density of π given z."""
    return float(dirichlet_log_density(log_weights, weights_concentration(prior, z)))


# φ^x = (μ^x, Σ^x)


def draw_categories(
    rng: np.random.Generator, prior: Prior, channel: Channel, z: Ints, settings: Settings
) -> tuple[Floats, Floats]:
    """Draw μ and the Cholesky factor of Σ of all K categories given z; an empty one comes from the prior."""
    law = gaussian_posterior(prior, channel.features, z)
    mean, factor = draw_gaussians(rng, law, settings.averaged_draws)
    if settings.empty_category == "uniform":
        empty = np.bincount(z, minlength=prior.categories) == 0
        mean[empty] = rng.uniform(*prior.box, size=(int(empty.sum()), mean.shape[1]))
    return mean, factor


def categories_log_density(prior: Prior, channel: Channel, z: Ints, mean: Floats, factor: Floats) -> float:
    """Log density of all μ and Σ of a channel given z."""
    return float(np.sum(giw_log_density(gaussian_posterior(prior, channel.features, z), mean, factor)))


# F_d: equation (25)


def word_log_weights(trials: Trials, z: tuple[Ints, ...], log_words: tuple[Floats, ...]) -> Floats:
    """(T, C) log θ^x_{z, w} of each word under each channel x, z the category of the channel's speaker."""
    columns = [
        log_words[c][z[c][channel.speaker[trials.word_trial]], trials.words[c]]
        for c, channel in enumerate(trials.channels)
    ]
    return np.stack(columns, axis=1)


def _frame_log_weights(log_weights: Floats, starts: Ints, length: int) -> Floats:
    """(sentences, frames) unnormalised log p(F_d = f | …) for the sentences of N words that begin at `starts`."""
    frames = distinct_frames(log_weights.shape[1], length)
    result = np.zeros((len(starts), len(frames)))
    for n in range(length):
        result += log_weights[starts + n][:, frames[:, n]]
    return result


def draw_frames(rng: np.random.Generator, trials: Trials, rule: Rule, log_weights: Floats) -> Ints:
    """Draw F (T,) given `word_log_weights`: whole frames, or word by word where the prior factorises."""
    if rule == "every":
        return np.empty(0, dtype=np.int64)
    if rule == "independent":
        return draw_categorical(rng, log_weights)
    F = np.empty(len(log_weights), dtype=np.int64)
    for length, starts in _sentences_by_length(trials):
        choice = draw_categorical(rng, _frame_log_weights(log_weights, starts, length))
        frames = distinct_frames(log_weights.shape[1], length)
        F[starts[:, None] + np.arange(length)] = frames[choice]
    return F


def frames_log_probability(trials: Trials, rule: Rule, log_weights: Floats, F: Ints) -> float:
    """Log probability of F given `word_log_weights`."""
    if rule == "every":
        return 0.0
    chosen = float(np.sum(log_weights[np.arange(len(F)), F]))
    if rule == "independent":
        return chosen - float(np.sum(log_sum(log_weights)))
    total = sum(
        float(np.sum(log_sum(_frame_log_weights(log_weights, starts, length))))
        for length, starts in _sentences_by_length(trials)
    )
    return chosen - total


def _sentences_by_length(trials: Trials) -> list[tuple[int, Ints]]:
    """For each N that occurs, N and the index of the first word of each sentence of N words."""
    lengths = trials.sentence_lengths
    starts = np.cumsum(lengths) - lengths
    return [(int(N), starts[lengths == N]) for N in np.unique(lengths) if N > 0]


# θ^x


def word_concentration(trials: Trials, index: int, prior: Prior, z: Ints, explained: NDArray[np.bool_]) -> Floats:
    """(K, W) parameters of θ_k | z, F ~ Dir(γ + n_{k,1}, …, γ + n_{k,W})."""
    counts = np.full((prior.categories, len(trials.vocabulary)), prior.word_concentration)
    speaker = trials.channels[index].speaker[trials.word_trial[explained]]
    np.add.at(counts, (z[speaker], trials.words[index, explained]), 1.0)
    return counts


def draw_words(rng: np.random.Generator, concentration: Floats, averaged_draws: int = 1) -> Floats:
    """Draw log θ (K, W); the log of the mean of several draws where `averaged_draws` is above 1."""
    draws = draw_log_dirichlet(rng, np.broadcast_to(concentration, (averaged_draws, *concentration.shape)))
    if averaged_draws == 1:
        return np.asarray(draws[0])
    top = draws.max(axis=0)
    return np.asarray(top + np.log(np.mean(np.exp(draws - top), axis=0)))


def words_log_density(concentration: Floats, log_words: Floats) -> float:
    """Log density of θ of a channel given its `word_concentration`."""
    return float(np.sum(dirichlet_log_density(log_words, concentration)))
