"""The action description task (section 4.4 of the paper): the robot says what it did."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import pandas as pd

from evaluation.scores import write_csv
from features.table import FeatureTable
from model import Fit
from model.prediction import describe

# The fixed frame of a description: action, position, color, object.
FRAME = ("action", "position", "color", "object")


@dataclass(frozen=True)
class Descriptions:
    """True and described words, a pair for each word that the tutor said of a trial.

    Attributes:
        trial: the trial of each pair.
        channel: the channel of each pair.
        true: what the tutor said.
        described: what the robot says.
    """

    trial: tuple[int, ...]
    channel: tuple[str, ...]
    true: tuple[str, ...]
    described: tuple[str, ...]


def describe_trials(fit: Fit, table: FeatureTable, words: Mapping[str, Sequence[str]]) -> Descriptions:
    """Describe each trial of a table, word by word, and pair each word with the tutor's.

    Args:
        fit: what the robot learned.
        table: the trials, with attended objects and the tutor's sentences.
        words: the words by channel; a tutor's word of no channel is left out.

    Raises:
        ValueError: the robot learned without words.
    """
    attended = {
        "action": table.action,
        "position": table.position[table.attended_row],
        "object": table.object_feature[table.attended_row],
        "color": table.color[table.attended_row],
    }
    spoken = {channel: describe(fit, channel, attended[channel]) for channel in FRAME}
    pairs = [
        (int(table.trial[d]), channel, word, spoken[channel][d])
        for d, sentence in enumerate(table.words)
        for channel in FRAME
        for word in sentence
        if word in words[channel]
    ]
    trial, channel_of, true, described = zip(*pairs, strict=True) if pairs else ((), (), (), ())
    return Descriptions(trial, channel_of, true, described)


def write_descriptions(conditions: Sequence[Mapping[str, object]], told: Sequence[Descriptions], path: Path) -> None:
    """Write every pair of a true and a described word, a row each, with the condition of the fit that described."""
    frames = [
        pd.DataFrame(asdict(one)).assign(**condition)  # type: ignore[arg-type]
        for condition, one in zip(conditions, told, strict=True)
    ]
    names = [*conditions[0], "trial", "channel", "true", "described"]
    write_csv(pd.concat(frames)[names], path)
