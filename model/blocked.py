"""The blocked Gibbs sampler, Algorithm 1 of the paper."""

from __future__ import annotations

import numpy as np
from scipy.cluster.vq import kmeans2

from model import conditionals as given
from model.data import Channel, Floats, Prior, Trials
from model.distributions import log_sum
from model.frames import Rule, refuse_long_sentences
from model.joint import Priors, draw_frames_prior
from model.state import Settings, State


def init(rng: np.random.Generator, trials: Trials, rule: Rule, priors: Priors, settings: Settings) -> State:
    """The first state: F at random, μ at k-means centres, Σ a multiple of I, π and θ from their priors.

    Raises:
        ValueError: a sentence is longer than the method's frames can be.
    """
    refuse_long_sentences(trials, rule)
    W = len(trials.vocabulary)
    log_weights, mean, factor, log_words = [], [], [], []
    for channel, prior in zip(trials.channels, priors, strict=True):
        K, dim = prior.categories, channel.features.shape[1]
        log_weights.append(_stick_breaking(rng, prior))
        mean.append(_centres(rng, channel, K))
        factor.append(np.tile(np.sqrt(settings.start_scale) * np.eye(dim), (K, 1, 1)))
        log_words.append(given.draw_words(rng, np.full((K, W), prior.word_concentration)))
    # The first step draws z before it reads it.
    z = tuple(np.zeros(len(channel.features), dtype=np.int64) for channel in trials.channels)
    F = draw_frames_prior(rng, trials, rule)
    return State(z, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words), F)


def step(
    rng: np.random.Generator, state: State, trials: Trials, rule: Rule, priors: Priors, settings: Settings
) -> State:
    """One iteration: z, π and φ of each channel, then F, then θ (model.md, section 3).

    Given z, F and θ the channels are independent, so that it makes no difference that the three
    updates of one channel are done before the next channel's.
    """
    explained = [given.explained_words(rule, state.F, c, len(trials.word_trial)) for c in range(len(trials.channels))]
    z, log_weights, mean, factor = [], [], [], []
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        log_assignment = given.assignment_log_weights(
            trials, c, state.log_weights[c], state.mean[c], state.factor[c], state.log_words[c], explained[c]
        )
        z.append(given.draw_assignments(rng, log_assignment))
        log_weights.append(given.draw_weights(rng, prior, z[c]))
        drawn_mean, drawn_factor = given.draw_categories(rng, prior, channel, z[c], settings)
        mean.append(drawn_mean)
        factor.append(drawn_factor)
    F = given.draw_frames(rng, trials, rule, given.word_log_weights(trials, tuple(z), state.log_words))
    log_words = []
    for c, prior in enumerate(priors):
        now_explained = given.explained_words(rule, F, c, len(trials.word_trial))
        concentration = given.word_concentration(trials, c, prior, z[c], now_explained)
        log_words.append(given.draw_words(rng, concentration, settings.averaged_draws))
    return State(tuple(z), tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words), F)


def _stick_breaking(rng: np.random.Generator, prior: Prior) -> Floats:
    """Log π from GEM(α) cut off after K pieces and normalised."""
    pieces = rng.beta(1.0, prior.concentration, size=prior.categories)
    tiny = np.finfo(np.float64).tiny
    rest = np.concatenate([[0.0], np.cumsum(np.log(np.maximum(1.0 - pieces[:-1], tiny)))])
    log_weights = np.log(np.maximum(pieces, tiny)) + rest
    return np.asarray(log_weights - log_sum(log_weights))


def _centres(rng: np.random.Generator, channel: Channel, K: int) -> Floats:
    """(K, dim) k-means centres; where there are fewer different points than K, the points, repeated."""
    distinct = np.unique(channel.features, axis=0)
    if len(distinct) <= K:
        return np.asarray(distinct[np.arange(K) % len(distinct)])
    centres, _ = kmeans2(channel.features, K, minit="++", missing="warn", rng=rng)
    return np.asarray(centres, dtype=np.float64)
