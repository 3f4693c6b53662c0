"""The collapsed sampler's conditional of F: the frame of one sentence given all others, θ integrated out."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints
from model.distributions.dirichlet import draw_index
from model.frames import FrameList
from model.kernels.collapsed_paths import swept_along_paths
from model.kernels.word_table import WordTable, count_part, word_table
from model.problem import Problem

# Sentences of a method whose frames factorise are drawn in parts of at most this many words.
MOST_JOINT_WORDS = 4


def sweep_frames(rng: np.random.Generator, problem: Problem, z: Sequence[Ints], F: Ints, temperature: float) -> Ints:
    """Draw F (T,) sentence by sentence given z and the frames of all other sentences; see `sweep_assignments`."""
    if len(F) == 0:
        return F
    paths = problem.paths
    if paths is not None and paths.once:
        table, bounds = word_table(problem, z, F), problem.trials.sentence_bounds
        return swept_along_paths(rng, F, temperature, problem.trials.words[0], bounds, table, paths)
    trials, allowed = problem.trials, problem.frame_prior.listed(problem.trials, MOST_JOINT_WORDS)
    return _swept_frames(
        rng, F, temperature, trials.words[0], trials.sentence_bounds, word_table(problem, z, F), allowed
    )


@compiled
def _swept_frames(
    rng: np.random.Generator,
    F: Ints,
    temperature: float,
    words: Ints,
    bounds: Ints,
    table: WordTable,
    allowed: FrameList,
) -> Ints:
    """Draw F sentence by sentence.

    Args:
        rng: The fit's generator.
        F: (T,) frames before.
        temperature: Divides the log weights; 1 for the posterior.
        words: (T,) index into the vocabulary.
        bounds: (D + 1,) the words of trial d are bounds[d] to bounds[d + 1] − 1.
        table: Counts under F; used up.
        allowed: The frames; longer sentences are drawn in parts, each given the others.

    Returns:
        F afterwards.
    """
    F, longest = F.copy(), allowed.frames.shape[1]
    for d in range(len(bounds) - 1):
        for start in range(bounds[d], bounds[d + 1], longest):
            length = min(longest, bounds[d + 1] - start)
            count_part(table, words, F, start, length, -1.0)
            log_weights = grown_log_weights(table, words, start, length, allowed)
            add_log_prior(log_weights, F, bounds[d], bounds[d + 1], start, length, allowed)
            chosen = allowed.bounds[length] + draw_index(rng, log_weights / temperature)
            for n in range(length):
                F[start + n] = allowed.frames[chosen, n]
            count_part(table, words, F, start, length, 1.0)
    return F


@compiled
def grown_log_weights(table: WordTable, words: Ints, start: int, length: int, allowed: FrameList) -> Floats:
    """(frames,) unnormalised log probability of each frame of the words start to start + length − 1.

    The counts grow within a frame, where two of its words share a category.

    Args:
        table: Counts without these words.
        words: (T,) all words.
        start: The first of these words.
        length: How many they are, at most the longest that is allowed.
        allowed: The frames.
    """
    C, W = len(table.row), table.counts.shape[1]
    # Log numerator of word n in channel c after `more` equal words there, log denominator after `more` words.
    numerator, denominator = np.empty((length, C, length)), np.empty((length, C, length))
    for n in range(length):
        for c in range(C):
            row = table.row[c, start + n]
            for more in range(length):
                gamma = table.gamma[row]
                numerator[n, c, more] = math.log(table.counts[row, words[start + n]] + gamma + more)
                denominator[n, c, more] = math.log(table.totals[row] + W * gamma + more)
    first, last = allowed.bounds[length], allowed.bounds[length + 1]
    result = np.zeros(last - first)
    for f in range(last - first):
        frame = allowed.frames[first + f]
        for n in range(length):
            equal, shared = 0, 0
            for earlier in range(n):
                if frame[earlier] == frame[n]:
                    shared += 1
                    if words[start + earlier] == words[start + n]:
                        equal += 1
            result[f] += numerator[n, frame[n], equal] - denominator[n, frame[n], shared]
    return result


@compiled
def add_log_prior(
    log_weights: Floats, F: Ints, first: int, last: int, start: int, length: int, allowed: FrameList
) -> None:
    """Add the log prior of each frame of a part, where frames are not all alike; those of the other words are F.

    Args:
        log_weights: (frames,) of the words start to start + length − 1.
        F: (T,) frames.
        first: The first word of the sentence.
        last: Behind its last word.
        start: The first word of the part.
        length: Words of the part.
        allowed: The frames.
    """
    if len(allowed.log_named) == 0:
        return
    none, named = allowed.frames.max(), 0  # ∅ is the last of the sources
    for t in range(first, last):
        if not start <= t < start + length:
            named += F[t] < none
    for f in range(len(log_weights)):
        more = 0
        for n in range(length):
            more += allowed.frames[allowed.bounds[length] + f, n] < none
        log_weights[f] += allowed.log_named[last - first, named + more]
