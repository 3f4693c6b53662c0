"""Feature tables: what the model learns from, and the two Parquet files that hold them.

The files are the contract that people who bring their own features also write: one row per trial in the one,
one row per object in the other. `features.table_columns` states the columns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from data_collection.files import replacing
from features.table_check import problems_of_tables
from features.table_columns import FILES, Words
from features.table_files import Read, load
from features.table_rounding import without_rounding
from features.table_types import conform
from features.table_values import stored, values_of

Texts = tuple[str | None, ...]


class TableError(ValueError):
    """The files of a feature table break the contract; `problems` lists every breach."""

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        count = f"{len(problems)} problem{'s' if len(problems) != 1 else ''} in the feature table"
        super().__init__("\n".join([f"{count} (rows counted from 0):", *problems]))


@dataclass(frozen=True, eq=False)
class FeatureTable:
    """D trials with N objects altogether. Trials ascend by number, objects by trial and index.

    Attributes:
        trial: int64 (D,), numbers of the trials, unique.
        attended_object: int64 (D,), A_d, index into the trial's objects; −1 where unknown.
        words: D sentences as uttered; a sentence may be empty.
        action: float64 (D, dim_a), a_d.
        trial_index: int64 (N,), row (0..D−1) of the trial that each object belongs to, ascending.
        position: float64 (N, 2), p_dm, metres on the table, robot frame (x ahead, y left).
        object_feature: float64 (N, dim_o), o_dm.
        color: float64 (N, dim_c), c_dm, sums to 1.
        truth_action: True action word of each trial, None where unknown; None altogether when none is known.
        truth_position, truth_object, truth_color: The same for each object.
    """

    trial: NDArray[np.int64]
    attended_object: NDArray[np.int64]
    words: tuple[tuple[str, ...], ...]
    action: NDArray[np.float64]
    trial_index: NDArray[np.int64]
    position: NDArray[np.float64]
    object_feature: NDArray[np.float64]
    color: NDArray[np.float64]
    truth_action: Texts | None = None
    truth_position: Texts | None = None
    truth_object: Texts | None = None
    truth_color: Texts | None = None

    @property
    def first_object(self) -> NDArray[np.int64]:
        """int64 (D,): row of each trial's object 0 among the N objects."""
        return np.searchsorted(self.trial_index, np.arange(len(self.trial))).astype(np.int64)

    @property
    def attended_row(self) -> NDArray[np.int64]:
        """int64 (D,): row of each trial's attended object among the N objects; −1 where unknown."""
        return np.where(self.attended_object < 0, -1, self.first_object + self.attended_object)

    def learning_input(self) -> dict[str, Any]:
        """What the model learns from, as the arguments of `model.Trials.from_arrays`."""
        return {
            "action": self.action,
            "objects": {"position": self.position, "object": self.object_feature, "color": self.color},
            "trial_of_object": self.trial_index,
            "attended": self.attended_object,
            "sentences": self.words,
        }


def check_table(
    trials: Path | str, objects: Path | str, *, words: Words | None = None, need_attention: bool
) -> list[str]:
    """List every breach of the contract in two files: file, column, row, what is expected; see `import_table`."""
    try:
        import_table(trials, objects, words=words, need_attention=need_attention)
    except TableError as error:
        return list(error.problems)
    return []


def import_table(
    trials: Path | str, objects: Path | str, *, words: Words | None = None, need_attention: bool
) -> FeatureTable:
    """Read a feature table of unknown origin, in child processes with limited memory.

    What its program wrote otherwise than the contract says is converted where nothing is lost (`import_with_notes`
    says what): whole numbers and vectors of other types, colors that sum to 1 but for rounding, and texts in another
    normal form of Unicode than C.

    Args:
        trials: Parquet file of the trials, or a folder of such files.
        objects: The same of the objects.
        words: The experiment's words of each channel; with it, any other word is a breach.
        need_attention: Whether every trial's `attended_object` must be known (training needs it).

    Raises:
        TableError: The files break the contract; the message lists all problems.
    """
    return import_with_notes(trials, objects, words=words, need_attention=need_attention)[0]


def import_with_notes(
    trials: Path | str, objects: Path | str, *, words: Words | None = None, need_attention: bool
) -> tuple[FeatureTable, list[str]]:
    """What `import_table` reads, and a line for each thing that was converted or passed over.

    Raises:
        TableError: The files break the contract; the message lists all problems.
    """
    from features.foreign_tables import load_apart

    paths = Path(trials), Path(objects)
    read = load_apart(dict(zip(FILES, paths, strict=True)))
    each = [without_rounding(path, read[key], FILES[key]) for key, path in zip(FILES, paths, strict=True)]
    return _sound_table(paths, each, words, need_attention), [note for one in each for note in one.notes]


def read_table(trials: Path | str, objects: Path | str, *, need_attention: bool) -> FeatureTable:
    """Read a feature table that `write_table` wrote; rows may stand in any order.

    Raises:
        TableError: The files break the contract; the message lists all problems.
    """
    paths = Path(trials), Path(objects)
    read = [load(path, columns) for path, columns in zip(paths, FILES.values(), strict=True)]
    return _sound_table(paths, read, None, need_attention)


def _sound_table(
    paths: tuple[Path, Path],
    read: Sequence[Read],
    words: Words | None,
    need_attention: bool,
) -> FeatureTable:
    """The table of two files that were read.

    Raises:
        TableError: There were problems, or the values break the contract.
    """
    trials, objects = (one.table for one in read)
    problems = [problem for one in read for problem in one.problems]
    problems += problems_of_tables(paths, trials, objects, need_attention=need_attention, words=words)
    if problems:
        raise TableError(problems)
    trials = trials.sort_by("trial")
    objects = objects.sort_by([("trial", "ascending"), ("object", "ascending")])
    values = {column.name: values_of(objects, column) for column in FILES["objects"]}
    owner = values.pop("trial")
    del values["object"]  # 0, 1, … in each trial, now that the rows are sorted
    values |= {column.name: values_of(trials, column) for column in FILES["trials"]}
    return FeatureTable(trial_index=np.searchsorted(values["trial"], owner).astype(np.int64), **values)


def read_metadata(path: Path | str) -> dict[str, str]:
    """Read the metadata that `write_table` was given from one of its files."""
    stored = pq.read_schema(path).metadata or {}
    return {key.decode(): value.decode() for key, value in stored.items() if not key.startswith(b"ARROW:")}


def write_table(
    table: FeatureTable,
    trials: Path | str,
    objects: Path | str,
    metadata: Mapping[str, str] | None = None,
) -> None:
    """Write both files; the same table and metadata give the same bytes.

    Args:
        table: What to write; columns of truth that are None are left out.
        trials: Where the trials go.
        objects: Where the objects go.
        metadata: Key-value metadata of both files.

    Raises:
        TableError: The table itself breaks the contract; no file is written.
    """
    paths = (Path(trials), Path(objects))
    parts = _arrow(table)
    problems = []
    for path, part, columns in zip(paths, parts, FILES.values(), strict=True):
        problems += conform(str(path), part, columns)[1]
    problems += problems_of_tables(paths, *parts, need_attention=False)
    if problems:
        raise TableError(problems)
    with replacing(*paths) as temporary:
        for path, part in zip(temporary, parts, strict=True):
            sorted_metadata = dict(sorted((metadata or {}).items()))
            pq.write_table(part.replace_schema_metadata(sorted_metadata), path, write_page_checksum=True)


def head(table: FeatureTable, D: int) -> FeatureTable:
    """Return the first D trials by number, with their objects.

    Raises:
        ValueError: D is below 1 or above the number of trials.
    """
    if not 1 <= D <= len(table.trial):
        raise ValueError(f"D is {D}; expected 1 to {len(table.trial)}, the number of trials")
    N = int(np.searchsorted(table.trial_index, D))

    def first(values: Any, count: int) -> Any:
        return None if values is None else values[:count]

    by_trial = {column.name for column in FILES["trials"]}
    return FeatureTable(**{name: first(values, D if name in by_trial else N) for name, values in vars(table).items()})


def _arrow(table: FeatureTable) -> tuple[Any, ...]:
    """The Arrow tables of both files."""
    index = np.arange(len(table.trial_index)) - table.first_object[table.trial_index]
    parts = vars(table), vars(table) | {"trial": table.trial[table.trial_index], "object": index}
    return tuple(
        pa.table({one.name: stored(values, one) for one in columns if (values := part[one.name]) is not None})
        for part, columns in zip(parts, FILES.values(), strict=True)
    )
