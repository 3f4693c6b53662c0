"""The joint distribution: draws from the prior and the model, and its logarithm, equations (1) to (10)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from model.compiled import compiled
from model.data import Channel, Floats, Ints
from model.distributions.dirichlet import (
    count_log_marginal,
    dirichlet_log_density,
    draw_categorical,
    draw_log_dirichlet,
)
from model.distributions.gaussian_densities import gaussian_log_density, gaussian_log_marginal, giw_log_density
from model.distributions.gaussians import draw_posterior_gaussians, gaussian_posterior
from model.kernels.words import none_counts, word_counts, word_log_weights
from model.prior import GaussianPrior
from model.problem import Problem
from model.state import Partition, State


def log_joint(problem: Problem, state: State) -> float:
    """Log p(X, w, z, F, π, φ, θ) of the data and the whole state, λ integrated out; p(κ0) where it is learned."""
    total = problem.log_hyperprior + problem.frame_prior.log_probability(problem.trials, state.F)
    per_word = word_log_weights(problem, state.z, state.log_words)
    for c, (channel, prior) in enumerate(zip(problem.trials.channels, problem.priors, strict=True)):
        z, log_weights, K = state.z[c], state.log_weights[c], prior.categories
        before = gaussian_posterior(channel.features[:0], z[:0], K, problem.gaussians[c])
        emission = gaussian_log_density(channel.features, state.mean[c], state.factor[c])
        word_prior = np.full(state.log_words[c].shape, prior.word_concentration)
        total += dirichlet_log_density(log_weights[None, :], np.full((1, K), prior.concentration / K))
        total += float(np.sum(log_weights[z]) + np.sum(emission[np.arange(len(z)), z]))
        total += float(np.sum(giw_log_density(before, state.mean[c], state.factor[c])))
        total += dirichlet_log_density(state.log_words[c], word_prior)
        total += float(np.sum(per_word[problem.counted(state.F, c), c]))
    if problem.frame_prior.has_none:
        C = len(problem.priors)
        total += dirichlet_log_density(
            state.log_words[C], np.full_like(state.log_words[C], problem.none_concentration)
        )
        total += float(np.sum(per_word[state.F == C, C]))
    return total


def log_constant(problem: Problem, state: Partition) -> float:
    """The part of `log_marginal_joint` that is the same for all z: log p(F), log p(κ0), and what normalises p(z)."""
    total = problem.log_hyperprior + problem.frame_prior.log_probability(problem.trials, state.F)
    for channel, prior in zip(problem.trials.channels, problem.priors, strict=True):
        total += math.lgamma(prior.concentration) - math.lgamma(prior.concentration + len(channel.features))
    return total


def log_marginal_joint(problem: Problem, state: Partition) -> float:
    """Log p(X, w, z, F), with p(κ0) where it is learned; π, φ, θ, λ integrated out: what all fits are compared by."""
    total = problem.log_hyperprior + problem.frame_prior.log_probability(problem.trials, state.F)
    for c, (channel, prior) in enumerate(zip(problem.trials.channels, problem.priors, strict=True)):
        counts = word_counts(problem, c, state.z[c], state.F)
        weight, gamma = prior.concentration / prior.categories, prior.word_concentration
        total += _channel_log_marginal(channel.features, state.z[c], counts, weight, gamma, problem.gaussians[c])
    if problem.frame_prior.has_none:
        of_none = np.equal(state.F, len(problem.priors)).astype(np.float64)
        total += count_log_marginal(none_counts(problem, of_none), problem.none_concentration)
    return total


@compiled
def _channel_log_marginal(
    features: Floats, z: Ints, words: Floats, weight: float, gamma: float, prior: GaussianPrior
) -> float:
    """Log p(X, w, z) of a channel with word counts (K, W), `weight` being α/K."""
    posterior = gaussian_posterior(features, z, len(words), prior)
    categories = count_log_marginal(posterior.counts.reshape(1, -1), weight)
    emissions = gaussian_log_marginal(prior, posterior)
    return categories + emissions + count_log_marginal(words, gamma)


def draw_mean_precision(rng: np.random.Generator, problem: Problem) -> Problem:
    """Draw κ0 of the channels that learn it from its prior."""
    values = [prior.mean_precisions for prior in problem.priors]
    return problem.given(own[int(rng.integers(len(own)))] for own in values)


def draw_parameters(rng: np.random.Generator, problem: Problem) -> State:
    """Draw everything that is not observed from the prior, given κ0.

    Of the trials only the layout is used: the numbers of trials, elements, words and dimensions.
    """
    design = problem.trials
    z, log_weights, mean, factor, log_words = [], [], [], [], []
    for c, (channel, prior) in enumerate(zip(design.channels, problem.priors, strict=True)):
        K = prior.categories
        log_weights.append(draw_log_dirichlet(rng, np.full((1, K), prior.concentration / K), 1)[0])
        z.append(draw_categorical(rng, np.tile(log_weights[-1], (len(channel.features), 1))))
        nothing = channel.features[:0], z[-1][:0]
        drawn_mean, drawn_factor = draw_posterior_gaussians(rng, *nothing, K, 1, problem.gaussians[c])
        mean.append(drawn_mean)
        factor.append(drawn_factor)
        log_words.append(draw_log_dirichlet(rng, np.full((K, len(design.vocabulary)), prior.word_concentration), 1))
    if problem.frame_prior.has_none:
        log_words.append(draw_log_dirichlet(rng, np.full((1, len(design.vocabulary)), problem.none_concentration), 1))
    F = problem.frame_prior.draw(rng, design)
    return State(tuple(z), F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))


def draw_data(rng: np.random.Generator, problem: Problem, state: State) -> Problem:
    """Draw features and words given a state; without frames each channel utters a sentence of its own."""
    design = problem.trials
    channels = tuple(
        replace(channel, features=_draw_features(rng, channel, state.z[c], state.mean[c], state.factor[c]))
        for c, channel in enumerate(design.channels)
    )
    said = [
        draw_categorical(rng, state.log_words[c][state.z[c][channel.speaker[design.word_trial]]])
        for c, channel in enumerate(design.channels)
    ]
    if problem.frame_prior.has_none:
        said.append(draw_categorical(rng, np.repeat(state.log_words[-1], len(design.word_trial), axis=0)))
    spoken = np.stack(said)
    if problem.frame_prior.has_frames:
        spoken = np.tile(spoken[state.F, np.arange(spoken.shape[1])], (len(channels), 1))
    return replace(problem, trials=replace(design, channels=channels, words=spoken))


def _draw_features(rng: np.random.Generator, channel: Channel, z: Ints, mean: Floats, factor: Floats) -> Floats:
    noise = rng.standard_normal(channel.features.shape)
    return np.asarray(mean[z] + np.einsum("nij,nj->ni", factor[z], noise))
