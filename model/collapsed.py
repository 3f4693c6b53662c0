"""The collapsed Gibbs sampler: only z and F are sampled, one element and one sentence at a time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from model.kernels.collapsed_assignments import element_log_weights, sweep_assignments
from model.kernels.collapsed_frames import part_log_weights, sweep_frames
from model.kernels.conditionals import explained_words, word_concentration, word_counts
from model.data import Flags, Floats, Ints, Trials
from model.frames import FrameList, Rule, frame_list, refuse_long_sentences
from model.distributions.gaussians import gaussian_posterior
from model.joint import Priors, draw_frames_prior
from model.prior import Prior
from model.kernels.start import k_means
from model.state import Partition, State

# Sentences of a method whose frames factorise are drawn in parts of so many words.
LONGEST_PART = 4


def init(rng: np.random.Generator, trials: Trials, rule: Rule, priors: Priors) -> Partition:
    """The first state: z by k-means, F at random.

    Raises:
        ValueError: a sentence is longer than the method's frames can be.
    """
    refuse_long_sentences(trials, rule)
    z = tuple(
        k_means(rng, channel.features, prior.categories)[1]
        for channel, prior in zip(trials.channels, priors, strict=True)
    )
    return Partition(z, draw_frames_prior(rng, trials, rule))


def step(
    rng: np.random.Generator,
    state: Partition,
    trials: Trials,
    rule: Rule,
    priors: Priors,
    temperature: float = 1.0,
) -> Partition:
    """One sweep: each element of each channel, then each sentence (docs/model.md, The two samplers)."""
    z = list(state.z)
    for c, prior in enumerate(priors):
        explained = explained_words(rule, state.F, c, len(trials.word_trial))
        z[c] = draw_assignments(rng, trials, c, prior, z[c], explained, temperature)
    return Partition(tuple(z), draw_frames(rng, trials, rule, priors, z, state.F, temperature))


# z^x


def draw_assignments(
    rng: np.random.Generator, trials: Trials, c: int, prior: Prior, z: Ints, explained: Flags, temperature: float
) -> Ints:
    """Draw z of channel c, element by element given all other elements and which words (T,) it explains."""
    counts = word_counts(trials, c, prior, z, explained)
    return sweep_assignments(rng, z, temperature, counts, *_elements(trials, c, prior, explained))[0]


def assignment_log_weights(trials: Trials, c: int, prior: Prior, z: Ints, explained: Flags, i: int) -> Floats:
    """(K,) unnormalised log p(z_i = k | …) of element i of channel c, which `draw_assignments` draws from."""
    counts = word_counts(trials, c, prior, z, explained)
    return element_log_weights(z, i, counts, *_elements(trials, c, prior, explained))


def _elements(
    trials: Trials, c: int, prior: Prior, explained: Flags
) -> tuple[Floats, Ints, Ints, Ints, Flags, float, float, float, float, float, float]:
    """Data and hyperparameters of channel c, in the order in which `sweep_assignments` takes them."""
    channel, weight = trials.channels[c], prior.concentration / prior.categories
    words, (order, bounds) = trials.words[c], trials.words_by_element[c]
    posterior = prior.gaussian(channel.dim)
    return channel.features, words, order, bounds, explained, weight, prior.word_concentration, *posterior


# F


def draw_frames(
    rng: np.random.Generator,
    trials: Trials,
    rule: Rule,
    priors: Priors,
    z: Sequence[Ints],
    F: Ints,
    temperature: float,
) -> Ints:
    """Draw F (T,) sentence by sentence given z and the frames of all other sentences."""
    if rule == "every" or len(F) == 0:
        return F
    table, allowed = _word_table(trials, rule, priors, z, F), allowed_frames(rule, trials)
    return sweep_frames(rng, F, temperature, trials.words[0], trials.sentence_bounds, *table, *allowed)


def frame_log_weights(
    trials: Trials, rule: Rule, priors: Priors, z: Sequence[Ints], F: Ints, start: int, length: int
) -> Floats:
    """(frames,) unnormalised log p(F = f | …) for the words start to start + length − 1, which `draw_frames` uses."""
    table, allowed = _word_table(trials, rule, priors, z, F), allowed_frames(rule, trials)
    return part_log_weights(F, start, length, trials.words[0], *table, *allowed)


def allowed_frames(rule: Rule, trials: Trials) -> FrameList:
    """The frames of whole sentences; of parts of sentences where their prior factorises."""
    longest = max(1, int(trials.sentence_lengths.max()))
    return frame_list(rule, len(trials.channels), longest if rule == "distinct" else min(longest, LONGEST_PART))


def _word_table(
    trials: Trials, rule: Rule, priors: Priors, z: Sequence[Ints], F: Ints
) -> tuple[Floats, Floats, Ints]:
    """The word counts of the categories of all channels: counts, γ and rows of `WordTable`."""
    counts, gamma, rows, first = [], [], [], 0
    for c, prior in enumerate(priors):
        explained = explained_words(rule, F, c, len(trials.word_trial))
        counts.append(word_counts(trials, c, prior, z[c], explained))
        gamma += [prior.word_concentration] * prior.categories
        rows.append(first + z[c][trials.word_speaker[c]])
        first += prior.categories
    return np.concatenate(counts), np.array(gamma), np.stack(rows)


# π, φ and θ


def posterior_means(trials: Trials, rule: Rule, priors: Priors, state: Partition) -> State:
    """π, φ and θ at their posterior means given z and F, so that all samplers end with the same parameters.

    Where the mean of Σ does not exist, with ν_n ≤ dim + 1 (an empty category, and ν0 ≤ dim + 1), its mode stands in.
    """
    log_weights, mean, factor, log_words = [], [], [], []
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        posterior = gaussian_posterior(channel.features, state.z[c], prior.categories, *prior.gaussian(channel.dim))
        excess = posterior.degrees_of_freedom - channel.dim - 1.0
        divisor = np.where(excess > 0.0, excess, posterior.degrees_of_freedom + channel.dim + 1.0)
        explained = explained_words(rule, state.F, c, len(trials.word_trial))
        log_weights.append(_log_means(posterior.counts + prior.concentration / prior.categories))
        mean.append(posterior.mean)
        factor.append(np.ascontiguousarray(posterior.upper.transpose(0, 2, 1)) / np.sqrt(divisor)[:, None, None])
        log_words.append(_log_means(word_concentration(trials, c, prior, state.z[c], explained)))
    return State(state.z, state.F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))


def _log_means(concentration: Floats) -> Floats:
    """Logarithms of the means of Dirichlet distributions along the last axis."""
    return np.asarray(np.log(concentration / concentration.sum(axis=-1, keepdims=True)))
