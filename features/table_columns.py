"""The columns of a feature table's two Parquet files, as data, and reading files into exactly these.

Equivalent Arrow encodings are accepted, because other programs write them: any integer width, single or
double precision, `large_*`, view, dictionary and fixed-size types. Everything else is reported by name.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from features.size_limits import MAX_TABLE_BYTES, MAX_TABLE_ROWS, MAX_TABLE_VALUES, MAX_TEXT_BYTES

Kind = Literal["integer", "text", "words", "vector"]

EXPECTED: Mapping[Kind, Any] = {
    "integer": pa.int64(),
    "text": pa.string(),
    "words": pa.list_(pa.string()),
    "vector": pa.list_(pa.float64()),
}


@dataclass(frozen=True)
class Column:
    """One column of the contract.

    Attributes:
        name: its name in the file.
        kind: integer (int64), text (string), words (list of string) or vector (list of double).
        required: whether the file must have it; a column that is not required may also be all null.
        nullable: whether a value may be null.
        length: length of every vector; None where any length will do, the same in all rows.
        histogram: whether a vector must be non-negative and sum to 1.
        channel: the channel whose words a text must be one of.

    """

    name: str
    kind: Kind
    required: bool = True
    nullable: bool = False
    length: int | None = None
    histogram: bool = False
    channel: str | None = None


TRIALS = (
    Column("trial", "integer"),
    Column("attended_object", "integer", nullable=True),
    Column("words", "words"),
    Column("action", "vector"),
    Column("truth_action", "text", required=False, nullable=True, channel="action"),
)
OBJECTS = (
    Column("trial", "integer"),
    Column("object", "integer"),
    Column("position", "vector", length=2),
    Column("object_feature", "vector"),
    Column("color", "vector", histogram=True),
    Column("truth_position", "text", required=False, nullable=True, channel="position"),
    Column("truth_object", "text", required=False, nullable=True, channel="object"),
    Column("truth_color", "text", required=False, nullable=True, channel="color"),
)
FILES = {"trials": TRIALS, "objects": OBJECTS}
"""The columns of each of a table's two files."""
DAMAGED = "not a Parquet file, truncated or damaged"


def load(path: Path, columns: Sequence[Column]) -> tuple[Any, list[str]]:
    """Read a Parquet file as an Arrow table with the usable ones of `columns`, in their expected types.

    Returns the table, or None when the file cannot be read, and the problems of file and column types.
    """
    if not path.is_file():
        return None, [f"{path}: no such file" if not path.exists() else f"{path}: not a file"]
    if path.stat().st_size > MAX_TABLE_BYTES:
        return None, [f"{path}: {path.stat().st_size:,} bytes; at most {MAX_TABLE_BYTES:,} are read"]
    try:
        with pq.ParquetFile(path) as file:
            if problems := _too_big(path, file.metadata):
                return None, problems
            # Only columns that the contract knows are read, and texts as dictionaries: a short list of long texts
            # could else become gigabytes.
            usable, problems = _fitting(str(path), file.schema_arrow, columns)
            names = [column.name for column in usable]
            texts = [leaf.path for leaf in map(file.schema.column, range(len(file.schema))) if _is_text(leaf)]
        with pq.ParquetFile(path, read_dictionary=texts, page_checksum_verification=True) as file:
            # One by one: Arrow does not join the dictionaries of lists of texts.
            groups = [file.read_row_group(i, names, use_threads=False) for i in range(file.num_row_groups)]
            table = pa.concat_tables(groups) if groups else pa.Table.from_batches([], file.schema_arrow)
            table = table.select(names)
            table.validate(full=True)
            if names and table.num_rows != file.metadata.num_rows:
                raise ValueError(f"{table.num_rows:,} rows, but the footer says {file.metadata.num_rows:,}")
            if long := [name for name in names if _longest_text(table.column(name)) > MAX_TEXT_BYTES]:
                return None, [f"{path}: column {long[0]!r} has a text of more than {MAX_TEXT_BYTES} bytes"]
            kept, more = conform(str(path), table, usable)
    except MemoryError:
        return None, [f"{path}: takes more memory than a table may"]
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        return None, [f"{path}: {DAMAGED}: {reason}"]
    return kept, problems + more


def _too_big(path: Path, metadata: Any) -> list[str]:
    """Refuse a file by what its footer says that it holds."""
    groups = [metadata.row_group(i) for i in range(metadata.num_row_groups)]
    chunks = [[group.column(j) for group in groups] for j in range(metadata.num_columns)]
    unpacked = sum(chunk.total_uncompressed_size for column in chunks for chunk in column)
    counts = [
        (_is_text(metadata.schema.column(j)), sum(chunk.num_values for chunk in column))
        for j, column in enumerate(chunks)
    ]
    texts = max((count for text, count in counts if text), default=0)
    values = max((count for text, count in counts if not text), default=0)
    if unpacked > MAX_TABLE_BYTES or values > MAX_TABLE_VALUES or max(metadata.num_rows, texts) > MAX_TABLE_ROWS:
        return [
            f"{path}: holds {metadata.num_rows:,} rows, up to {values:,} numbers and {texts:,} texts in one column "
            f"and {unpacked:,} bytes; at most {MAX_TABLE_ROWS:,} rows and texts, {MAX_TABLE_VALUES:,} numbers and "
            f"{MAX_TABLE_BYTES:,} bytes are read"
        ]
    return []


def _is_text(leaf: Any) -> bool:
    """Whether a column of a Parquet schema holds texts or other bytes."""
    return str(leaf.physical_type) == "BYTE_ARRAY"


def _longest_text(values: Any) -> int:
    """Bytes of the longest text of a column that was read as a dictionary; 0 for another column."""
    longest = 0
    for chunk in values.chunks:
        inner = (
            chunk.values if hasattr(chunk.type, "value_type") and not pa.types.is_dictionary(chunk.type) else chunk
        )
        if pa.types.is_dictionary(inner.type):
            longest = max(longest, pc.max(pc.binary_length(inner.dictionary)).as_py() or 0)
    return longest


def conform(file: str, table: Any, columns: Sequence[Column]) -> tuple[Any, list[str]]:
    """Keep the usable ones of `columns` in their expected types, and report what is wrong with the others."""
    usable, problems = _fitting(file, table.schema, columns)
    kept = {}
    for column in usable:
        expected = EXPECTED[column.kind]
        try:
            values = table.column(column.name).cast(expected)
            kept[column.name] = pa.concat_arrays(values.chunks or [pa.array([], expected)])
        except pa.ArrowInvalid as error:
            problems.append(f"{file}: column {column.name!r}: {error}; expected {expected}")
    return pa.table(kept), problems


def _fitting(file: str, schema: Any, columns: Sequence[Column]) -> tuple[list[Column], list[str]]:
    """Give the ones of `columns` that a schema has in a fitting type, and what is wrong with the others."""
    names = [column.name for column in columns]
    problems = [f"{file}: unknown column {name!r}; allowed: {', '.join(names)}"
                for name in dict.fromkeys(schema.names) if name not in names]  # fmt: skip
    usable = []
    for column in columns:
        count = schema.names.count(column.name)
        expected = EXPECTED[column.kind]
        if count > 1:
            problems.append(f"{file}: column {column.name!r} occurs {count} times; expected once")
        elif count == 1 and _is_kind(schema.field(column.name).type, column):
            usable.append(column)
        elif count == 1:
            type_ = schema.field(column.name).type
            problems.append(f"{file}: column {column.name!r} has type {type_}; expected {expected}")
        elif column.required:
            problems.append(f"{file}: column {column.name!r} is missing; expected {expected}")
    return usable, problems


def _is_kind(type_: Any, column: Column) -> bool:
    """Whether an Arrow type holds the column's kind without loss."""

    def is_text(type_: Any) -> bool:
        if pa.types.is_dictionary(type_):
            type_ = type_.value_type
        return any(test(type_) for test in (pa.types.is_string, pa.types.is_large_string, pa.types.is_string_view))

    is_list = pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list
    if pa.types.is_null(type_):
        return column.nullable
    if column.kind == "integer":
        return bool(pa.types.is_integer(type_))
    if column.kind == "text":
        return is_text(type_)
    if not any(test(type_) for test in is_list):
        return False
    if column.kind == "vector":
        return bool(pa.types.is_floating(type_.value_type))
    # a file in which every sentence is empty has no type of word
    return bool(pa.types.is_null(type_.value_type)) or is_text(type_.value_type)


def nulls(array: Any) -> NDArray[np.bool_]:
    """Which values of an Arrow array are null."""
    return np.asarray(np.from_dlpack(array.is_null().cast(pa.int8())), dtype=bool)


def numbers(array: Any, missing: float) -> NDArray[Any]:
    """The values of an Arrow array of numbers, `missing` where one is null.

    Not by `np.asarray`: that imports pandas, a fifth of a second for each of hundreds of fits.
    """
    known = np.from_dlpack(array.drop_null())
    values = np.full(len(array), missing, dtype=known.dtype)
    values[~nulls(array)] = known
    return values
