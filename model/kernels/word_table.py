"""The word counts of all categories in one table, for the collapsed sampler's conditional of F."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints
from model.kernels.words import none_counts, word_counts
from model.problem import Problem


class WordTable(NamedTuple):
    """The word counts of all L = K_a + K_p + K_o + K_c categories, one below the other, and last that of ∅.

    Attributes:
        counts: (L, W) n_{l,w}.
        totals: (L,) sums over the vocabulary.
        gamma: (L,) γ of each category's channel.
        row: (sources, T) the row of each word, should its frame point at channel c, or at ∅.
    """

    counts: Floats
    totals: Floats
    gamma: Floats
    row: Ints


def word_table(problem: Problem, z: Sequence[Ints], F: Ints) -> WordTable:
    """The word counts of the categories of all channels."""
    counts, gamma, rows, first = [], [], [], 0
    for c, prior in enumerate(problem.priors):
        counts.append(word_counts(problem, c, z[c], F))
        gamma += [prior.word_concentration] * prior.categories
        rows.append(first + z[c][problem.trials.word_speaker[c]])
        first += prior.categories
    if problem.frame_prior.has_none:
        counts.append(none_counts(problem, np.equal(F, len(problem.priors)).astype(np.float64)))
        gamma.append(problem.none_concentration)
        rows.append(np.full(len(F), first))
    table = np.concatenate(counts)
    return WordTable(table, table.sum(axis=1), np.array(gamma), np.stack(rows))


@compiled
def count_part(table: WordTable, words: Ints, F: Ints, start: int, length: int, change: float) -> None:
    """Add `change` for the words start to start + length − 1, under their frames, to the table."""
    for t in range(start, start + length):
        row = table.row[F[t], t]
        table.counts[row, words[t]] += change
        table.totals[row] += change
