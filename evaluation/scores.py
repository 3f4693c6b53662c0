"""The one tidy file of measures, from which every table is made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from evaluation.metrics import Truth, adjusted_rand_index, channel_by_word, estimation_accuracy_rate
from features.files import replacing
from features.table import FeatureTable
from model import METHODS, Fit

CONDITION = [
    "experiment",
    "variant",
    "task",
    "method",
    "inference",
    "averaged_draws",
    "chains",
    "D",
    "ROW",
    "seed",
]
COLUMNS = [*CONDITION, "measure", "value"]
# The letter that names a channel in measures and figures.
LETTERS = {"action": "a", "position": "p", "object": "o", "color": "c"}


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
    has_frames = METHODS[fit.method].has_frames
    measures["EAR"] = estimation_accuracy_rate(fit.state.F, true_channels) if has_frames else None
    for c, name in enumerate(channels):
        measures[f"used_{LETTERS[name]}"] = float(len(np.unique(fit.state.z[c])))
    return measures


def score_rows(condition: Mapping[str, object], measures: Mapping[str, float | None]) -> list[dict[str, object]]:
    """One row a measure, in the columns of `scores.csv`."""
    return [{**condition, "measure": measure, "value": value} for measure, value in measures.items()]


def write_scores(rows: Iterable[Mapping[str, object]], path: Path) -> None:
    """Write rows as CSV; an undefined value is an empty field."""
    write_csv(pd.DataFrame(list(rows), columns=COLUMNS), path)


def read_scores(paths: Iterable[Path]) -> pd.DataFrame:
    """Read and join score files.

    Raises:
        ValueError: a file has other columns.
    """
    frames = []
    for path in paths:
        frame = pd.read_csv(path)
        if list(frame.columns) != COLUMNS:
            raise ValueError(f"{path}: columns {list(frame.columns)}, not {COLUMNS}")
        frames.append(frame)
    return pd.concat(frames, ignore_index=True)


def join_scores(paths: Iterable[Path], path: Path) -> None:
    """Join score files into one, in their order."""
    write_csv(read_scores(paths), path)


def write_csv(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV; the file appears only when it is complete."""
    with replacing(path) as (temporary,):
        frame.to_csv(temporary, index=False, lineterminator="\n")
