"""The words that categories explain: counts, distributions θ^x given z and F, and log probabilities of the words."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints
from model.problem import Problem


def word_counts(problem: Problem, c: int, z: Ints, F: Ints) -> Floats:
    """(K, W) how often the words that count for category (x, k) are each word, z that of channel c."""
    return weighted_word_counts(problem, c, z, problem.counted(F, c).astype(np.float64))


def weighted_word_counts(problem: Problem, c: int, z: Ints, weights: Floats) -> Floats:
    """(K, W) the same where channel c explains a word only in part, or with a probability: `weights` (T,), 0 to 1."""
    trials = problem.trials
    shape = problem.priors[c].categories, len(trials.vocabulary)
    return _count_words(shape, trials.words[c], trials.word_speaker[c], weights, z)


@compiled
def _count_words(shape: tuple[int, int], words: Ints, speaker: Ints, weights: Floats, z: Ints) -> Floats:
    """Counts of `shape` (K, W), see `weighted_word_counts`."""
    counts = np.zeros(shape)
    for t in range(len(words)):
        if weights[t] > 0.0:
            counts[z[speaker[t]], words[t]] += weights[t]
    return counts


def word_concentration(problem: Problem, c: int, z: Ints, F: Ints) -> Floats:
    """(K, W) parameters of θ_k | z, F ~ Dir(γ + n_{k,1}, …, γ + n_{k,W})."""
    return problem.priors[c].word_concentration + word_counts(problem, c, z, F)


def none_counts(problem: Problem, weights: Floats) -> Floats:
    """(1, W) how often each word is of no channel, as `weights` (T,) say, 0 to 1."""
    W = len(problem.trials.vocabulary)
    return np.bincount(problem.trials.words[0], weights, minlength=W).astype(np.float64)[None]


def none_concentration(problem: Problem, F: Ints) -> Floats:
    """(1, W) parameters of θ^∅ | F ~ Dir(γ + n^∅_1, …, γ + n^∅_W)."""
    return problem.none_concentration + none_counts(problem, np.equal(F, len(problem.priors)).astype(np.float64))


def word_log_weights(problem: Problem, z: tuple[Ints, ...], log_words: tuple[Floats, ...]) -> Floats:
    """(T, sources) log θ^x_{z, w} of each word under each channel x, z that of the channel's speaker, and under ∅."""
    trials = problem.trials
    columns = [log_words[c][z[c][trials.word_speaker[c]], trials.words[c]] for c in range(len(trials.channels))]
    columns += [log_none[0, trials.words[0]] for log_none in log_words[len(columns) :]]
    return np.ascontiguousarray(np.stack(columns, axis=1))
