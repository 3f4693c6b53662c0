"""Cross-situational learning: the measures of one fit (section 4.2 of the paper)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from evaluation.measure import Measure, Words
from evaluation.metrics import adjusted_rand_index, channel_by_word, estimation_accuracy_rate
from evaluation.scores import LETTERS
from features.table import FeatureTable
from model import Fit


@dataclass(frozen=True)
class Learned:
    """What the measures are taken of.

    Attributes:
        fit: the fit.
        table: the feature table that was fitted, with its truth where it is known.
    """

    fit: Fit
    table: FeatureTable

    def truth(self, channel: str) -> Sequence[str | None] | None:
        """The true words of a channel's elements."""
        known: Sequence[str | None] | None = getattr(self.table, f"truth_{channel}")
        return known

    def categories(self, channel: str) -> np.ndarray:
        """The estimated categories of a channel's elements."""
        return self.fit.state.z[self.fit.trials.index_of(channel)]


def _ari(channel: str, learned: Learned, words: Words) -> float | None:
    return adjusted_rand_index(learned.categories(channel), learned.truth(channel))


def _ari_attended(channel: str, learned: Learned, words: Words) -> float | None:
    speaker = learned.fit.trials.channels[learned.fit.trials.index_of(channel)].speaker
    known = learned.truth(channel)
    return adjusted_rand_index(
        learned.categories(channel)[speaker], None if known is None else [known[i] for i in speaker]
    )


def _ear(learned: Learned, words: Words) -> float | None:
    trials = learned.fit.trials
    channel_of = channel_by_word(words, [channel.name for channel in trials.channels])
    true = [channel_of.get(trials.vocabulary[w]) for w in trials.words[0]]
    return estimation_accuracy_rate(learned.fit.state.F, true) if learned.fit.problem.method.has_frames else None


def _used(channel: str, learned: Learned, words: Words) -> float:
    return float(len(np.unique(learned.categories(channel))))


MEASURES = (
    *(Measure(f"ARI_{x}", partial(_ari, channel)) for channel, x in LETTERS.items()),
    *(
        Measure(f"ARI_{x}_attended", partial(_ari_attended, channel), in_tables=False)
        for channel, x in LETTERS.items()
        if channel != "action"
    ),
    Measure("EAR", _ear),
    *(Measure(f"used_{x}", partial(_used, channel), in_tables=False) for channel, x in LETTERS.items()),
)
