"""The words that categories explain: counts, distributions θ^x given z and F, and log probabilities of the words."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled
from model.data import Flags, Floats, Ints
from model.problem import Problem


def word_counts(problem: Problem, c: int, z: Ints, F: Ints) -> Floats:
    """(K, W) how often the words whose frame and category point at (x, k) are each word, z that of channel c."""
    trials = problem.trials
    shape = problem.priors[c].categories, len(trials.vocabulary)
    return _count_words(shape, trials.words[c], trials.word_speaker[c], problem.explained(F, c), z)


@compiled
def _count_words(shape: tuple[int, int], words: Ints, speaker: Ints, explained: Flags, z: Ints) -> Floats:
    """Counts of `shape` (K, W), see `word_counts`."""
    counts = np.zeros(shape)
    for t in range(len(words)):
        if explained[t]:
            counts[z[speaker[t]], words[t]] += 1.0
    return counts


def word_concentration(problem: Problem, c: int, z: Ints, F: Ints) -> Floats:
    """(K, W) parameters of θ_k | z, F ~ Dir(γ + n_{k,1}, …, γ + n_{k,W})."""
    return problem.priors[c].word_concentration + word_counts(problem, c, z, F)


def word_log_weights(problem: Problem, z: tuple[Ints, ...], log_words: tuple[Floats, ...]) -> Floats:
    """(T, C) log θ^x_{z, w} of each word under each channel x, z the category of the channel's speaker."""
    trials = problem.trials
    columns = [log_words[c][z[c][trials.word_speaker[c]], trials.words[c]] for c in range(len(trials.channels))]
    return np.ascontiguousarray(np.stack(columns, axis=1))
