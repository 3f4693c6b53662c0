"""The truth as a state of a fit's chain, and its log joint: what a chain that has found it would have."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from evaluation.metrics import channel_by_word
from evaluation.scores import Words
from features.table import FeatureTable
from model import Problem
from model.data import Ints
from model.silent import complete

# Sweeps over the silent elements, of which the second half counts.
SWEEPS = 500


def truth_log_joint(problem: Problem, table: FeatureTable, words: Words) -> float | None:
    """The log joint of the truth: words in their channels, what is spoken of in its classes, the rest by Gibbs.

    It is the mean over sweeps, as that of a fit is over its states: a chain that has found the truth moves the
    silent elements as well, and would be below the highest. Fits of one posterior are given the same draws, and so
    the same number.

    Returns:
        The log joint in nats; None where the truth is no state of the method: a class or the channel of a word is
        not known, a channel has more classes than categories, or more words in a sentence than a frame allows it.
    """
    spoken = [_categories(problem, c, table) for c in range(len(problem.priors))]
    F = _channels(problem, words)
    if F is None or any(own is None for own in spoken):
        return None
    known = [own for own in spoken if own is not None]
    trace = complete(np.random.default_rng(0), problem, known, F, SWEEPS).trace_log_joint
    return float(trace[SWEEPS // 2 :].mean())


def _categories(problem: Problem, c: int, table: FeatureTable) -> Ints | None:
    """(D,) the true class of what each sentence is about, numbered by name; None where there is no such state."""
    channel = problem.trials.channels[c]
    truth: Sequence[str | None] | None = getattr(table, f"truth_{channel.name}")
    classes = [None] if truth is None else [truth[i] for i in channel.speaker]
    known = sorted({name for name in classes if name is not None})
    if None in classes or len(known) > problem.priors[c].categories:
        return None
    return np.array([known.index(name) for name in classes if name is not None], dtype=np.int64)


def _channels(problem: Problem, words: Words) -> Ints | None:
    """(T,) the true channel of each word, nothing for a method without frames; None where there is no such state."""
    trials = problem.trials
    if not problem.method.has_frames:
        return np.empty(0, dtype=np.int64)
    channel_of = channel_by_word(words, [channel.name for channel in trials.channels])
    by_word = np.array([channel_of.get(word, -1) for word in trials.vocabulary], dtype=np.int64)
    F = by_word[trials.words[0]]
    if np.any(F < 0) or np.any(F >= problem.sources):
        return None
    # How many words of each sentence each channel explains.
    named = len(trials.channels) > F
    shares = np.bincount(trials.word_trial[named] * len(trials.channels) + F[named])
    return None if np.any(shares > problem.frame_prior.most_per_channel) else F
