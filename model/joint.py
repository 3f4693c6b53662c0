"""The joint distribution: draws from the prior and the model, and its logarithm, equations (1) to (10)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from model.compiled import compiled
from model.kernels.conditionals import draw_words, explained_words, word_counts, word_log_weights
from model.data import Channel, Floats, Ints, Trials
from model.distributions.dirichlet import (
    count_log_marginal,
    dirichlet_log_density,
    draw_categorical,
    draw_log_dirichlet,
)
from model.frames import Rule, count_frames, distinct_frames
from model.distributions.gaussian_densities import gaussian_log_density, gaussian_log_marginal, giw_log_density
from model.distributions.gaussians import draw_posterior_gaussians, gaussian_posterior
from model.prior import GaussianPrior, Prior
from model.state import State

Priors = Sequence[Prior]


def log_joint(trials: Trials, rule: Rule, priors: Priors, state: State) -> float:
    """Log p(X, w, z, F, π, φ, θ) of the data and the whole state."""
    total = frames_log_prior(trials, rule)
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        z, log_weights, K = state.z[c], state.log_weights[c], prior.categories
        posterior = gaussian_posterior(channel.features[:0], z[:0], K, *prior.gaussian(channel.dim))
        emission = gaussian_log_density(channel.features, state.mean[c], state.factor[c])
        word_prior = np.full(state.log_words[c].shape, prior.word_concentration)
        total += dirichlet_log_density(log_weights[None, :], np.full((1, K), prior.concentration / K))
        total += float(np.sum(log_weights[z]) + np.sum(emission[np.arange(len(z)), z]))
        total += float(np.sum(giw_log_density(posterior, state.mean[c], state.factor[c])))
        total += dirichlet_log_density(state.log_words[c], word_prior)
    per_word = word_log_weights(trials, state.z, state.log_words)
    explained = per_word if rule == "every" else per_word[np.arange(len(state.F)), state.F]
    return total + float(np.sum(explained))


def log_marginal_joint(trials: Trials, rule: Rule, priors: Priors, z: Sequence[Ints], F: Ints) -> float:
    """Log p(X, w, z, F), with π, φ and θ integrated out: what fits of all samplers are compared by."""
    total = frames_log_prior(trials, rule)
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        explained = explained_words(rule, F, c, len(trials.word_trial))
        counts = word_counts(trials, c, prior, z[c], explained)
        weight, gamma = prior.concentration / prior.categories, prior.word_concentration
        total += _channel_log_marginal(channel.features, z[c], counts, weight, gamma, *prior.gaussian(channel.dim))
    return total


@compiled
def _channel_log_marginal(
    features: Floats,
    z: Ints,
    words: Floats,
    weight: float,
    gamma: float,
    m0: float,
    kappa0: float,
    scale: float,
    nu0: float,
) -> float:
    """Log p(X, w, z) of a channel with word counts (K, W), `weight` being α/K."""
    posterior = gaussian_posterior(features, z, len(words), m0, kappa0, scale, nu0)
    categories = count_log_marginal(posterior.counts.reshape(1, -1), weight)
    emissions = gaussian_log_marginal(GaussianPrior(m0, kappa0, scale, nu0), posterior)
    return categories + emissions + count_log_marginal(words, gamma)


def frames_log_prior(trials: Trials, rule: Rule) -> float:
    """Log ∏_d λ: each allowed frame of a sentence is as probable as any other, equation (1)."""
    lengths, sentences = np.unique(trials.sentence_lengths, return_counts=True)
    return -sum(
        int(n) * float(np.log(count_frames(rule, len(trials.channels), int(N))))
        for N, n in zip(lengths, sentences, strict=True)
    )


def draw_parameters(rng: np.random.Generator, design: Trials, rule: Rule, priors: Priors) -> State:
    """Draw everything that is not observed from the prior, for trials laid out like `design`.

    Of `design` the numbers of trials, elements, words and dimensions are used, not the values.
    """
    z, log_weights, mean, factor, log_words = [], [], [], [], []
    for channel, prior in zip(design.channels, priors, strict=True):
        K = prior.categories
        log_weights.append(draw_log_dirichlet(rng, np.full((1, K), prior.concentration / K), 1)[0])
        z.append(draw_categorical(rng, np.tile(log_weights[-1], (len(channel.features), 1))))
        nothing = channel.features[:0], z[-1][:0]
        drawn_mean, drawn_factor = draw_posterior_gaussians(rng, *nothing, K, 1, *prior.gaussian(channel.dim))
        mean.append(drawn_mean)
        factor.append(drawn_factor)
        log_words.append(draw_words(rng, np.full((K, len(design.vocabulary)), prior.word_concentration)))
    F = draw_frames_prior(rng, design, rule)
    return State(tuple(z), F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))


def draw_frames_prior(rng: np.random.Generator, design: Trials, rule: Rule) -> Ints:
    """Draw F (T,) uniformly over the allowed frames; empty for a method without frames."""
    C = len(design.channels)
    if rule == "every":
        return np.empty(0, dtype=np.int64)
    if rule == "independent":
        return rng.integers(C, size=len(design.word_trial))
    frames = [distinct_frames(C, int(N)) for N in design.sentence_lengths if N > 0]
    chosen = [allowed[rng.integers(len(allowed))] for allowed in frames]
    return np.concatenate(chosen) if chosen else np.empty(0, dtype=np.int64)


def draw_data(rng: np.random.Generator, design: Trials, rule: Rule, state: State) -> Trials:
    """Draw features and words given a state; each channel utters its own sentence for method (C)."""
    channels = tuple(
        replace(channel, features=_draw_features(rng, channel, state.z[c], state.mean[c], state.factor[c]))
        for c, channel in enumerate(design.channels)
    )
    spoken = np.stack(
        [
            draw_categorical(rng, state.log_words[c][state.z[c][channel.speaker[design.word_trial]]])
            for c, channel in enumerate(design.channels)
        ]
    )
    if rule != "every":
        spoken = np.tile(spoken[state.F, np.arange(spoken.shape[1])], (len(channels), 1))
    return replace(design, channels=channels, words=spoken)


def _draw_features(rng: np.random.Generator, channel: Channel, z: Ints, mean: Floats, factor: Floats) -> Floats:
    noise = rng.standard_normal(channel.features.shape)
    return np.asarray(mean[z] + np.einsum("nij,nj->ni", factor[z], noise))
