"""The action description task (section 4.4 of the paper): the robot says what it did."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from evaluation.scores import CONDITION
from features.table import FeatureTable
from model import Fit
from model.prediction import describe, spoken_order

# The frame of a description where no order is learned: action, position, color, object.
FRAME = ("action", "position", "color", "object")
COLUMNS = ["trial", "channel", "true", "described"]


def describe_trials(fit: Fit, table: FeatureTable, words: Mapping[str, Sequence[str]]) -> pd.DataFrame:
    """Describe each trial of a table, word by word, and pair each word with the tutor's.

    Args:
        fit: What the robot learned.
        table: The trials, with attended objects and the tutor's sentences.
        words: The words by channel; a tutor's word of no channel is left out.

    Returns:
        A row for each word that the tutor said of a trial; columns `COLUMNS`: `true` is the tutor's word, and
        `described` what the robot says for the channel.

    Raises:
        ValueError: The robot learned without words.
    """
    spoken = spoken_of(fit, table)
    pairs = [
        (int(table.trial[d]), channel, word, spoken[channel][d])
        for d, sentence in enumerate(table.words)
        for channel in spoken
        for word in sentence
        if word in words[channel]
    ]
    return pd.DataFrame(pairs, columns=COLUMNS)


def spoken_of(fit: Fit, table: FeatureTable) -> dict[str, tuple[str, ...]]:
    """What the robot says of each trial of a table with attended objects: by channel a word per trial.

    The channels are in the learned order of words, or in that of `FRAME`. Words of no channel are not said.

    Raises:
        ValueError: The robot learned without words.
    """
    attended = {
        "action": table.action,
        "position": table.position[table.attended_row],
        "object": table.object_feature[table.attended_row],
        "color": table.color[table.attended_row],
    }
    return {channel: describe(fit, channel, attended[channel]) for channel in spoken_order(fit) or FRAME}


def read_descriptions(paths: Sequence[Path]) -> pd.DataFrame:
    """Read and join files of descriptions, whose rows name the fit as well; without files, no rows."""
    frames = [pd.read_csv(path, keep_default_na=False) for path in paths]
    return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame(columns=[*CONDITION, *COLUMNS])
