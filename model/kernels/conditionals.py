"""The conditional distributions of the blocked Gibbs sampler, equations (11) to (25).

Each block has one draw and one log function. The log functions are what the tests hold
against the joint distribution: a conditional is right if it is proportional to the joint.
"""

from __future__ import annotations

import numpy as np

from model.compiled import compiled
from model.data import Channel, Flags, Floats, Ints, Trials
from model.distributions.dirichlet import dirichlet_log_density, draw_categorical, draw_index, draw_log_dirichlet, log_total
from model.frames import FrameList, Rule, frame_list
from model.distributions.gaussian_densities import gaussian_log_density, giw_log_density
from model.distributions.gaussians import draw_posterior_gaussians, gaussian_posterior
from model.prior import Prior
from model.state import Settings


def explained_words(rule: Rule, F: Ints, channel: int, count: int) -> Flags:
    """(T,) whether a channel explains each word: by its frame, or always where there is no frame."""
    return np.ones(count, dtype=np.bool_) if rule == "every" else F == channel


# z^x: equations (21) to (24) of the paper's section 3.3


def assignment_log_weights(
    trials: Trials, c: int, log_weights: Floats, mean: Floats, factor: Floats, log_words: Floats, explained: Flags
) -> Floats:
    """(N, K) unnormalised log p(z = k | …) of channel c: π_k N(x | μ_k, Σ_k) ∏ θ_{k,w}."""
    result = gaussian_log_density(trials.channels[c].features, mean, factor)
    _add_words(result, log_weights, log_words, trials.words[c], trials.word_speaker[c], explained)
    return result


@compiled
def _add_words(
    result: Floats, log_weights: Floats, log_words: Floats, words: Ints, speaker: Ints, explained: Flags
) -> None:
    """Add log π to (N, K) log densities, and log θ of the explained words to their speakers' rows."""
    result += log_weights
    for t in range(len(words)):
        if explained[t]:
            for k in range(len(log_weights)):
                result[speaker[t], k] += log_words[k, words[t]]


def draw_assignments(rng: np.random.Generator, log_weights: Floats) -> Ints:
    """Draw z from the rows of `assignment_log_weights`."""
    return draw_categorical(rng, log_weights)


# π^x


def weights_concentration(prior: Prior, z: Ints) -> Floats:
    """(1, K) parameters of π | z ~ Dir(α/K + n_1, …, α/K + n_K)."""
    K = prior.categories
    return np.asarray(prior.concentration / K + np.bincount(z, minlength=K)[None, :], dtype=np.float64)


def draw_weights(rng: np.random.Generator, prior: Prior, z: Ints) -> Floats:
    """Draw log π given z."""
    return np.asarray(draw_log_dirichlet(rng, weights_concentration(prior, z), 1)[0])


def weights_log_density(prior: Prior, z: Ints, log_weights: Floats) -> float:
    """Log density of π given z."""
    return dirichlet_log_density(log_weights[None, :], weights_concentration(prior, z))


# φ^x = (μ^x, Σ^x)


def draw_categories(
    rng: np.random.Generator, prior: Prior, channel: Channel, z: Ints, settings: Settings
) -> tuple[Floats, Floats]:
    """Draw μ and the Cholesky factor of Σ of all K categories given z; an empty one comes from the prior."""
    K, posterior = prior.categories, prior.gaussian(channel.dim)
    mean, factor = draw_posterior_gaussians(rng, channel.features, z, K, settings.averaged_draws, *posterior)
    if settings.empty_category == "uniform":
        empty = np.bincount(z, minlength=K) == 0
        mean[empty] = rng.uniform(*prior.box, size=(int(empty.sum()), mean.shape[1]))
    return mean, factor


def categories_log_density(prior: Prior, channel: Channel, z: Ints, mean: Floats, factor: Floats) -> float:
    """Log density of all μ and Σ of a channel given z."""
    posterior = gaussian_posterior(channel.features, z, prior.categories, *prior.gaussian(channel.dim))
    return float(np.sum(giw_log_density(posterior, mean, factor)))


# F_d: equation (25)


def word_log_weights(trials: Trials, z: tuple[Ints, ...], log_words: tuple[Floats, ...]) -> Floats:
    """(T, C) log θ^x_{z, w} of each word under each channel x, z the category of the channel's speaker."""
    columns = [log_words[c][z[c][trials.word_speaker[c]], trials.words[c]] for c in range(len(trials.channels))]
    return np.ascontiguousarray(np.stack(columns, axis=1))


def allowed_frames(rule: Rule, trials: Trials) -> FrameList:
    """The frames to choose from: of whole sentences, or of single words where their prior factorises."""
    longest = max(1, int(trials.sentence_lengths.max())) if rule == "distinct" else 1
    return frame_list(rule, len(trials.channels), longest)


def draw_frames(rng: np.random.Generator, trials: Trials, rule: Rule, log_weights: Floats) -> Ints:
    """Draw F (T,) given `word_log_weights`: whole frames, or word by word where the prior factorises."""
    if rule == "every":
        return np.empty(0, dtype=np.int64)
    return _draw_frames(rng, log_weights, trials.sentence_bounds, *allowed_frames(rule, trials))


def frames_log_probability(trials: Trials, rule: Rule, log_weights: Floats, F: Ints) -> float:
    """Log probability of F given `word_log_weights`."""
    if rule == "every":
        return 0.0
    return _frames_log_probability(log_weights, trials.sentence_bounds, F, *allowed_frames(rule, trials))


@compiled
def _draw_frames(
    rng: np.random.Generator, log_weights: Floats, bounds: Ints, frames: Ints, frame_bounds: Ints
) -> Ints:
    """Draw F (T,) of the sentences with words bounds[d] to bounds[d + 1] − 1; frames as in `FrameList`."""
    allowed, longest = FrameList(frames, frame_bounds), frames.shape[1]
    F = np.empty(len(log_weights), dtype=np.int64)
    for d in range(len(bounds) - 1):
        for start in range(bounds[d], bounds[d + 1], longest):
            length = min(longest, bounds[d + 1] - start)
            chosen = draw_index(rng, _part_log_weights(log_weights, start, length, allowed))
            for n in range(length):
                F[start + n] = allowed.frames[allowed.bounds[length] + chosen, n]
    return F


@compiled
def _frames_log_probability(log_weights: Floats, bounds: Ints, F: Ints, frames: Ints, frame_bounds: Ints) -> float:
    """Log probability of F (T,), see `_draw_frames`."""
    allowed, longest = FrameList(frames, frame_bounds), frames.shape[1]
    total = 0.0
    for d in range(len(bounds) - 1):
        for start in range(bounds[d], bounds[d + 1], longest):
            length = min(longest, bounds[d + 1] - start)
            total -= log_total(_part_log_weights(log_weights, start, length, allowed))
            for n in range(length):
                total += log_weights[start + n, F[start + n]]
    return total


@compiled
def _part_log_weights(log_weights: Floats, start: int, length: int, allowed: FrameList) -> Floats:
    """(frames,) unnormalised log probability of each frame of the words start to start + length − 1."""
    first, last = allowed.bounds[length], allowed.bounds[length + 1]
    result = np.zeros(last - first)
    for f in range(last - first):
        for n in range(length):
            result[f] += log_weights[start + n, allowed.frames[first + f, n]]
    return result


# θ^x


def word_counts(trials: Trials, c: int, prior: Prior, z: Ints, explained: Flags) -> Floats:
    """(K, W) how often the words whose frame and category point at (x, k) are each word."""
    shape = prior.categories, len(trials.vocabulary)
    return _count_words(shape, trials.words[c], trials.word_speaker[c], explained, z)


@compiled
def _count_words(shape: tuple[int, int], words: Ints, speaker: Ints, explained: Flags, z: Ints) -> Floats:
    """Counts of `shape` (K, W), see `word_counts`."""
    counts = np.zeros(shape)
    for t in range(len(words)):
        if explained[t]:
            counts[z[speaker[t]], words[t]] += 1.0
    return counts


def word_concentration(trials: Trials, c: int, prior: Prior, z: Ints, explained: Flags) -> Floats:
    """(K, W) parameters of θ_k | z, F ~ Dir(γ + n_{k,1}, …, γ + n_{k,W})."""
    return prior.word_concentration + word_counts(trials, c, prior, z, explained)


def draw_words(rng: np.random.Generator, concentration: Floats, averaged_draws: int = 1) -> Floats:
    """Draw log θ (K, W); the log of the mean of several draws where `averaged_draws` is above 1."""
    return draw_log_dirichlet(rng, concentration, averaged_draws)


def words_log_density(concentration: Floats, log_words: Floats) -> float:
    """Log density of θ of a channel given its `word_concentration`."""
    return dirichlet_log_density(log_words, concentration)
