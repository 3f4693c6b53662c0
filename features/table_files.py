"""Read a Parquet file into exactly the columns of the contract.

Equivalent Arrow encodings are accepted, because other programs write them: any integer width, single or double
precision, `large_*`, view, dictionary and fixed-size types. Everything else is reported by name.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from features.size_limits import MAX_TABLE_BYTES, MAX_TABLE_ROWS, MAX_TABLE_VALUES, MAX_TEXT_BYTES
from features.table_columns import EXPECTED, Column

DAMAGED = "not a Parquet file, truncated or damaged"


def load(path: Path, columns: Sequence[Column]) -> tuple[Any, list[str]]:
    """Read a Parquet file as an Arrow table of the usable ones of `columns`, in the types of the contract.

    Returns:
        The table, or None if the file cannot be read, and the problems of the file and of its columns' types.
    """
    if not path.is_file():
        return None, [f"{path}: no such file" if not path.exists() else f"{path}: not a file"]
    if path.stat().st_size > MAX_TABLE_BYTES:
        return None, [f"{path}: {path.stat().st_size:,} bytes; at most {MAX_TABLE_BYTES:,} are read"]
    try:
        return _load(path, columns)
    except MemoryError:
        return None, [f"{path}: larger than a table may be: reading it takes too much memory"]
    except (pa.ArrowException, OSError, ValueError) as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        return None, [f"{path}: {DAMAGED}: {reason}"]


def _load(path: Path, columns: Sequence[Column]) -> tuple[Any, list[str]]:
    with pq.ParquetFile(path) as parquet:
        leaves = [parquet.schema.column(i) for i in range(len(parquet.schema))]
        values = _values_per_leaf(parquet.metadata)
        if problems := _too_big(path, parquet.metadata, leaves, values):
            return None, problems
        usable, problems = _fitting(str(path), parquet.schema_arrow, columns)
    # Unknown columns are not read. Texts are read as dictionaries: a short list of long texts could otherwise
    # become gigabytes.
    names = [column.name for column in usable]
    texts = [leaf.path for leaf in leaves if _is_text(leaf)]
    with pq.ParquetFile(path, read_dictionary=texts, page_checksum_verification=True) as parquet:
        # One group at a time: Arrow does not join the dictionaries of lists of texts.
        groups = [parquet.read_row_group(i, names, use_threads=False) for i in range(parquet.num_row_groups)]
        table = pa.concat_tables(groups) if groups else pa.Table.from_batches([], parquet.schema_arrow)
    table = table.select(names)
    table.validate(full=True)
    for leaf, expected in zip(leaves, values, strict=True):
        name = leaf.path.split(".")[0]
        if name in names and (found := _count(table.column(name))) != expected:
            raise ValueError(f"column {name!r} holds {found:,} values, but the footer says {expected:,}")
    for name in names:
        if _longest_text(table.column(name)) > MAX_TEXT_BYTES:
            return None, [f"{path}: column {name!r} has a text of more than {MAX_TEXT_BYTES} bytes"]
    kept, more = conform(str(path), table, usable)
    return kept, problems + more


def _values_per_leaf(metadata: Any) -> list[int]:
    """How many values each column holds according to the footer; an empty list counts as one."""
    groups = [metadata.row_group(i) for i in range(metadata.num_row_groups)]
    if sum(group.num_rows for group in groups) != metadata.num_rows:
        raise ValueError("the row groups do not have as many rows as the file")
    return [sum(group.column(i).num_values for group in groups) for i in range(metadata.num_columns)]


def _too_big(path: Path, metadata: Any, leaves: Sequence[Any], values: Sequence[int]) -> list[str]:
    """Refuse a file that would be too big when unpacked, by what its footer says."""
    unpacked = sum(metadata.row_group(i).total_byte_size for i in range(metadata.num_row_groups))
    texts = max((count for leaf, count in zip(leaves, values, strict=True) if _is_text(leaf)), default=0)
    numbers = max((count for leaf, count in zip(leaves, values, strict=True) if not _is_text(leaf)), default=0)
    rows = metadata.num_rows
    if unpacked > MAX_TABLE_BYTES or numbers > MAX_TABLE_VALUES or max(rows, texts) > MAX_TABLE_ROWS:
        return [
            f"{path}: holds {rows:,} rows, up to {numbers:,} numbers and {texts:,} texts in one column and "
            f"{unpacked:,} bytes; at most {MAX_TABLE_ROWS:,} rows and texts, {MAX_TABLE_VALUES:,} numbers and "
            f"{MAX_TABLE_BYTES:,} bytes are read"
        ]
    return []


def _is_text(leaf: Any) -> bool:
    """Whether a column of a Parquet schema holds texts or other bytes."""
    return str(leaf.physical_type) == "BYTE_ARRAY"


def _is_list(type_: Any) -> bool:
    return any(test(type_) for test in (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list))


def _count(values: Any) -> int:
    """How many values a column holds, as Parquet counts them: an empty or missing list is one."""
    if not _is_list(values.type):
        return len(values)
    return pc.sum(pc.max_element_wise(pc.list_value_length(values), 1)).as_py() or 0


def _longest_text(values: Any) -> int:
    """Bytes of the longest text of a column that was read as a dictionary; 0 for any other column."""
    longest = 0
    for chunk in values.chunks:
        inner = chunk.values if _is_list(chunk.type) else chunk
        if pa.types.is_dictionary(inner.type):
            longest = max(longest, pc.max(pc.binary_length(inner.dictionary)).as_py() or 0)
    return longest


def conform(file: str, table: Any, columns: Sequence[Column]) -> tuple[Any, list[str]]:
    """Keep the usable ones of `columns` in the types of the contract, and report what is wrong with the others."""
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
    """The ones of `columns` that a schema has in a fitting type, and what is wrong with the others."""
    names = [column.name for column in columns]
    problems = [
        f"{file}: unknown column {name!r}; allowed: {', '.join(names)}"
        for name in dict.fromkeys(schema.names)
        if name not in names
    ]
    usable = []
    for column in columns:
        count = schema.names.count(column.name)
        where, expected = f"{file}: column {column.name!r}", EXPECTED[column.kind]
        if count > 1:
            problems.append(f"{where} occurs {count} times; expected once")
        elif count == 0 and column.required:
            problems.append(f"{where} is missing; expected {expected}")
        elif count == 1 and not _fits(type_ := schema.field(column.name).type, column):
            problems.append(f"{where} has type {type_}; expected {expected}")
        elif count == 1:
            usable.append(column)
    return usable, problems


def _fits(type_: Any, column: Column) -> bool:
    """Whether an Arrow type holds the column's kind without loss."""
    if pa.types.is_null(type_):
        return column.nullable
    if column.kind == "integer":
        return bool(pa.types.is_integer(type_))
    if column.kind == "text":
        return _holds_text(type_)
    if not _is_list(type_):
        return False
    if column.kind == "vector":
        return bool(pa.types.is_floating(type_.value_type))
    # A file whose sentences are all empty has no type of word.
    return bool(pa.types.is_null(type_.value_type)) or _holds_text(type_.value_type)


def _holds_text(type_: Any) -> bool:
    type_ = type_.value_type if pa.types.is_dictionary(type_) else type_
    return any(test(type_) for test in (pa.types.is_string, pa.types.is_large_string, pa.types.is_string_view))


def nulls(array: Any) -> NDArray[np.bool_]:
    """Which values of an Arrow array are null."""
    return np.asarray(np.from_dlpack(array.is_null().cast(pa.int8())), dtype=bool)


def numbers(array: Any, missing: float) -> NDArray[Any]:
    """The values of an Arrow array of numbers, `missing` where one is null.

    `np.asarray` would import pandas, which takes a fifth of a second in each of hundreds of fits.
    """
    known = np.from_dlpack(array.drop_null())
    values = np.full(len(array), missing, dtype=known.dtype)
    values[~nulls(array)] = known
    return values
