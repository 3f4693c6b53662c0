"""Cross-situational learning: the measures of one fit (section 4.2 of the paper)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from evaluation.metrics import Truth, adjusted_rand_index, channel_by_word, estimation_accuracy_rate
from evaluation.scores import LETTERS
from features.table import FeatureTable
from model import Fit


def csl_measures(fit: Fit, table: FeatureTable, words: Mapping[str, Sequence[str]]) -> dict[str, float | None]:
    """The measures of cross-situational learning of one fit; None where one is not defined.

    Args:
        fit: the fit.
        table: the feature table that was fitted, with its truth where it is known.
        words: the words by channel.
    """
    channels = [channel.name for channel in fit.trials.channels]
    truth: dict[str, Truth] = {name: getattr(table, f"truth_{name}") for name in channels}
    measures: dict[str, float | None] = {}
    for c, name in enumerate(channels):
        measures[f"ARI_{LETTERS[name]}"] = adjusted_rand_index(fit.state.z[c], truth[name])
    for c, channel in enumerate(fit.trials.channels):
        if channel.name == "action":
            continue
        known = truth[channel.name]
        attended = None if known is None else [known[i] for i in channel.speaker]
        measures[f"ARI_{LETTERS[channel.name]}_attended"] = adjusted_rand_index(
            fit.state.z[c][channel.speaker], attended
        )
    index = channel_by_word(words, channels)
    true_channels = [index.get(fit.trials.vocabulary[w]) for w in fit.trials.words[0]]
    has_frames = fit.problem.method.has_frames
    measures["EAR"] = estimation_accuracy_rate(fit.state.F, true_channels) if has_frames else None
    for c, name in enumerate(channels):
        measures[f"used_{LETTERS[name]}"] = float(len(np.unique(fit.state.z[c])))
    return measures
