"""The one tidy file of measures, from which every table is made."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import pandas as pd

from data_collection.files import replacing
from model import METHODS

# The words of an experiment, by channel.
Words = Mapping[str, Sequence[str]]
# What names a fit; its task is what is measured.
CONDITION = ["experiment", "dataset", "variant", "task", "method", "sampler", "D", "ROW", "seed"]
COLUMNS = [*CONDITION, "measure", "value"]
# What a value is one of: a data set of the experiment, and a seed within it.
UNITS = ["dataset", "seed"]
# What names the seeds of a fit together.
SEEDS = [key for key in CONDITION if key not in ("task", "seed")]
# What two methods share that are compared in a table.
SHARED = [key for key in SEEDS if key not in ("experiment", "dataset", "method")]
# What tells one row of a table from another, most general first.
ROW_KEYS = [*SHARED, "method"]
# The log joint of a fit, and that of the truth beside it.
LOG_JOINT, LOG_JOINT_TRUTH = "log_joint", "log_joint_truth"
# The words of no channel, ∅ in the model, beside those of the channels.
NONE = "none"
# The letter that names a channel in measures and figures.
LETTERS = {"action": "a", "position": "p", "object": "o", "color": "c"}


def in_order(frame: pd.DataFrame, keys: Sequence[str], **orders: Iterable[str]) -> pd.DataFrame:
    """The rows by these keys, methods in the order of `METHODS`.

    Args:
        frame: The rows.
        keys: Columns, the first before all others.
        orders: In which order the values of further columns come, such as samplers.
    """
    known = {name: list(order).index for name, order in ({"method": METHODS} | orders).items()}
    return frame.sort_values(
        list(keys), key=lambda own: own.map(known[own.name]) if own.name in known else own, ignore_index=True
    )


def varying(frame: pd.DataFrame, keys: Iterable[str], *always: str) -> list[str]:
    """The keys of which a table has more than one value, and those that are always told."""
    return [key for key in keys if key in always or frame[key].nunique() > 1]


def score_rows(condition: Mapping[str, object], measures: Mapping[str, float | None]) -> list[dict[str, object]]:
    """A row per measure, in the columns of `scores.csv`."""
    return [{**condition, "measure": measure, "value": value} for measure, value in measures.items()]


def write_scores(rows: Iterable[Mapping[str, object]], path: Path) -> None:
    """Write rows as CSV; an undefined value is an empty field."""
    write_csv(pd.DataFrame(list(rows), columns=COLUMNS), path)


def read_scores(paths: Iterable[Path]) -> pd.DataFrame:
    """Read and join score files.

    Raises:
        ValueError: A file has other columns.
    """
    frames = {path: pd.read_csv(path) for path in paths}
    for path, frame in frames.items():
        if list(frame.columns) != COLUMNS:
            raise ValueError(f"{path}: columns {list(frame.columns)}, not {COLUMNS}")
    return pd.concat(frames.values(), ignore_index=True)


def write_csv(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV; the file appears only when it is complete."""
    with replacing(path) as (temporary,):
        frame.to_csv(temporary, index=False, lineterminator="\n")
