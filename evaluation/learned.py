"""What was learned beside the truth: agreement of the last state, the summary and the kept states of a fit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evaluation.metrics import (
    adjusted_rand_index,
    channel_by_word,
    estimation_accuracy_rate,
    precision_and_recall,
)
from evaluation.scores import LETTERS, Words
from evaluation.truth import truth_log_joint
from features.table import FeatureTable
from model import Fit
from model.data import Ints
from model.history import burned

# Kept states of which intervals are taken, at most: a hundred or two tell quantiles as well as thousands.
MOST_STATES = 200


@dataclass(frozen=True)
class Learned:
    """A fit, and the feature table that was fitted, with its truth where it is known."""

    fit: Fit
    table: FeatureTable

    def categories(self, channel: str) -> Ints:
        """The categories of a channel's elements in the last state."""
        return self.fit.state.z[self.fit.trials.index_of(channel)]

    @cached_property
    def along(self) -> dict[str, list[float | None]]:
        """ARI of each channel in each of the kept states after burn-in; no state where none were kept."""
        if self.fit.kept is None:
            return {channel: [] for channel in LETTERS}
        states = self.fit.kept.thinned(MOST_STATES)
        index = self.fit.trials.index_of
        return {channel: [self._agreement(channel, z) for z in states.z[index(channel)]] for channel in LETTERS}

    def ari(self, channel: str, *, summary: bool = False, attended: bool = False) -> float | None:
        """ARI of the last state or of the point estimate, over all elements or over the attended objects.

        None without a summary, and where it is not defined.
        """
        states = self.fit.summary if summary else self.fit.state
        z = None if states is None else states.z[self.fit.trials.index_of(channel)]
        return self._agreement(channel, z, self.table.attended_row if attended else None)

    def ear(self, words: Words) -> float | None:
        """EAR of the last state."""
        return self._right(self.fit.state.F, words)

    def ear_mode(self, words: Words) -> float | None:
        """EAR of each word's most probable channel; None without a summary."""
        return None if self.fit.summary is None else self._right(self.fit.summary.channels, words)

    def ear_along(self, words: Words) -> list[float | None]:
        """EAR of each of the kept states after burn-in; no state where none were kept."""
        kept = self.fit.kept
        return [] if kept is None else [self._right(F, words) for F in kept.thinned(MOST_STATES).F]

    def none_precision(self, words: Words) -> float | None:
        """Of the words that the last state takes for words of no channel, the share that is."""
        return self._none(words)[0]

    def none_recall(self, words: Words) -> float | None:
        """Of the words of no channel, the share that the last state takes for such."""
        return self._none(words)[1]

    def word_entropy(self) -> float | None:
        """Mean entropy of the words' channels in nats; None without a summary, frames or words."""
        marginals = None if self.fit.summary is None else self.fit.summary.marginals
        if marginals is None or not len(marginals):
            return None
        # 0 ln 0 is 0, and 0 is not −0.
        logs = np.log(np.where(marginals > 0.0, marginals, 1.0))
        return abs(float(np.mean(np.sum(marginals * logs, axis=1))))

    def log_joint(self) -> float:
        """The mean log joint after burn-in, in nats."""
        trace = self.fit.trace_log_joint
        return float(trace[burned(self.fit.sampler.burn_in, len(trace)) :].mean())

    def log_joint_truth(self, words: Words) -> float | None:
        """The mean log joint of the truth; None where it is no state of the method, see `evaluation.truth`."""
        return truth_log_joint(self.fit.problem, self.table, words)

    def _agreement(self, channel: str, z: Ints | None, rows: Ints | None = None) -> float | None:
        truth = getattr(self.table, f"truth_{channel}")
        if z is None or truth is None:
            return None
        if rows is None:
            return adjusted_rand_index(z, truth)
        return adjusted_rand_index(z[rows], [truth[row] for row in rows])

    def _right(self, F: Ints, words: Words) -> float | None:
        if not self.fit.problem.method.has_frames:
            return None
        return estimation_accuracy_rate(F, self._true_channels(words))

    def _none(self, words: Words) -> tuple[float | None, float | None]:
        """Precision and recall of no channel; None for a method that has none."""
        if not self.fit.problem.frame_prior.has_none:
            return None, None
        none = len(self.fit.trials.channels)
        return precision_and_recall(self.fit.state.F, self._true_channels(words), none)

    def _true_channels(self, words: Words) -> list[int | None]:
        """The true channel of each word, None where it is not known."""
        trials = self.fit.trials
        channel_of = channel_by_word(words, [channel.name for channel in trials.channels])
        return [channel_of.get(trials.vocabulary[w]) for w in trials.words[0]]
