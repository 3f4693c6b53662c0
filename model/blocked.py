"""The blocked Gibbs sampler, Algorithm 1 of the paper."""

from __future__ import annotations

import numpy as np

from model.kernels import conditionals as given
from model.data import Trials
from model.frames import Rule, refuse_long_sentences
from model.joint import Priors, draw_frames_prior
from model.kernels.start import k_means, stick_breaking
from model.state import Settings, State


def init(rng: np.random.Generator, trials: Trials, rule: Rule, priors: Priors, settings: Settings) -> State:
    """The first state: F at random, μ at k-means centres, Σ a multiple of I, π and θ from their priors.

    Raises:
        ValueError: a sentence is longer than the method's frames can be.
    """
    refuse_long_sentences(trials, rule)
    W = len(trials.vocabulary)
    z, log_weights, mean, factor, log_words = [], [], [], [], []
    for channel, prior in zip(trials.channels, priors, strict=True):
        K = prior.categories
        centres, nearest = k_means(rng, channel.features, K)
        z.append(nearest)
        log_weights.append(stick_breaking(rng, prior.concentration, K))
        mean.append(centres)
        factor.append(np.tile(np.sqrt(settings.start_scale) * np.eye(channel.dim), (K, 1, 1)))
        log_words.append(given.draw_words(rng, np.full((K, W), prior.word_concentration)))
    F = draw_frames_prior(rng, trials, rule)
    return State(tuple(z), F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))


def step(
    rng: np.random.Generator, state: State, trials: Trials, rule: Rule, priors: Priors, settings: Settings
) -> State:
    """One iteration: z, π and φ of each channel, then F, then θ (Algorithm 1 of the paper).

    Given z, F and θ the channels are independent, so that it makes no difference that the three
    updates of one channel are done before the next channel's.
    """
    z, log_weights, mean, factor = [], [], [], []
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        explained = given.explained_words(rule, state.F, c, len(trials.word_trial))
        log_assignment = given.assignment_log_weights(
            trials, c, state.log_weights[c], state.mean[c], state.factor[c], state.log_words[c], explained
        )
        z.append(given.draw_assignments(rng, log_assignment))
        log_weights.append(given.draw_weights(rng, prior, z[c]))
        drawn_mean, drawn_factor = given.draw_categories(rng, prior, channel, z[c], settings)
        mean.append(drawn_mean)
        factor.append(drawn_factor)
    F = given.draw_frames(rng, trials, rule, given.word_log_weights(trials, tuple(z), state.log_words))
    log_words = []
    for c, prior in enumerate(priors):
        explained = given.explained_words(rule, F, c, len(trials.word_trial))
        concentration = given.word_concentration(trials, c, prior, z[c], explained)
        log_words.append(given.draw_words(rng, concentration, settings.averaged_draws))
    return State(tuple(z), F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))
