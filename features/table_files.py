"""Read a Parquet file, or a folder of them, into exactly the columns of the contract.

Every encoding that Arrow reads is accepted, whoever wrote it; `features.table_types` says which types are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from numpy.typing import NDArray

from features.size_limits import (
    MAX_TABLE_BYTES,
    MAX_TABLE_PARTS,
    MAX_TABLE_ROWS,
    MAX_TABLE_VALUES,
    MAX_TEXT_BYTES,
)
from features.table_columns import Column
from features.table_parts import PART_SUFFIXES, no_file, no_parquet, parts_of, restored
from features.table_types import conform, fitting, holds_text, is_list

NOT_READ = "uses a part of the Parquet format that is not read here (write it again with pandas or pyarrow)"
NOT_YET = "ot yet implemented"  # what Arrow says of such a part, be it as one error or another
FOOTER_LIMITS: Mapping[str, int] = {"thrift_string_size_limit": 2**30, "thrift_container_size_limit": 10**7}


@dataclass(frozen=True)
class Read:
    """What came of reading a file.

    Attributes:
        table: Arrow table of the usable columns of the contract, in its types; None if the file cannot be read.
        problems: What is wrong with the file and with its columns' types.
        notes: What was converted or passed over.
    """

    table: Any
    problems: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def load(path: Path, columns: Sequence[Column]) -> Read:
    """Read a Parquet file, or a folder of such files, as one table of the usable ones of `columns`."""
    parts = parts_of(path)
    if not parts:
        return Read(None, [f"{path}: a folder without Parquet files ({', '.join(PART_SUFFIXES)})"])
    if len(parts) > MAX_TABLE_PARTS:
        return Read(
            None, [f"{path}: {len(parts):,} Parquet files; at most {MAX_TABLE_PARTS:,} are read as one table"]
        )
    if problems := [problem for part in parts for problem in no_file(part)]:
        return Read(None, problems)
    try:
        return _load(path, parts, columns)
    except MemoryError:
        return Read(None, [f"{path}: larger than a table may be: reading it takes too much memory"])


def _load(path: Path, parts: Sequence[Path], columns: Sequence[Column]) -> Read:
    """Read parts one after the other, as long as all of them together are not too big."""
    read, sizes = [], []
    for part in parts:
        try:
            with pq.ParquetFile(part, **FOOTER_LIMITS) as parquet:
                sizes.append(_size(parquet))
            if problems := _too_big(path, sizes):
                return Read(None, problems)
            if len(parts) > 1 and sizes[-1][0] == 0:
                continue  # a part without rows often has no types either
            read.append(_load_part(part, columns))
        except MemoryError:
            raise
        except (pa.ArrowException, OSError, ValueError) as error:
            what = NOT_READ if NOT_YET in str(error) else no_parquet(part)
            return Read(None, [f"{part}: {what}: {_reason(error)}"])
    problems = [problem for each in read for problem in each.problems]
    problems += [] if read else [f"{path}: has no rows; expected at least one"]
    notes = list(dict.fromkeys(note for each in read for note in each.notes))
    if not read or any(each.table is None for each in read):
        return Read(None, problems, notes)
    return Read(pa.concat_tables([each.table for each in read], promote_options="default"), problems, notes)


def _reason(error: Exception) -> str:
    return str(error).splitlines()[0] if str(error) else type(error).__name__


def _load_part(path: Path, columns: Sequence[Column]) -> Read:
    with pq.ParquetFile(path, **FOOTER_LIMITS) as parquet:
        values = _values_per_leaf(parquet.metadata)
        # The column that each leaf belongs to; paths do not tell `words.x` from a part of it.
        fields = [field_.name for field_ in parquet.schema_arrow for _ in range(_leaves(field_.type))]
        leaves = [parquet.schema.column(i) for i in range(len(parquet.schema))]
        absent = restored(path, parquet.schema_arrow, columns, parquet.metadata.num_rows)
        usable, problems, notes = fitting(str(path), parquet.schema_arrow, columns, tuple(absent))
    # Unknown columns are not read. Texts are read as dictionaries: a short list of long texts could otherwise
    # become gigabytes.
    names = [column.name for column in usable if column.name not in absent]
    texts = [leaf.path for leaf in leaves if _is_text(leaf)]
    try:
        table = _groups(path, names, texts)
    except (pa.ArrowNotImplementedError, OSError) as error:
        if NOT_YET not in str(error):
            raise
        # An encoding that Arrow reads, but not as a dictionary.
        table = _groups(path, names, [])
    table.validate(full=True)
    for name in names:
        expected = [value for field_, value in zip(fields, values, strict=True) if field_ == name]
        if len(expected) == 1 and (found := _count(table.column(name))) != expected[0]:
            raise ValueError(f"column {name!r} holds {found:,} values, but the footer says {expected[0]:,}")
        if _longest_text(table.column(name)) > MAX_TEXT_BYTES:
            return Read(None, [f"{path}: column {name!r} has a text of more than {MAX_TEXT_BYTES} bytes"])
    for name, array in absent.items():
        table = table.append_column(name, array)
    kept, more, converted = conform(str(path), table, usable)
    return Read(kept, problems + more, notes + converted)


def _groups(path: Path, names: Sequence[str], texts: Sequence[str]) -> Any:
    """Columns of a file, `texts` as dictionaries."""
    options = {**FOOTER_LIMITS, "read_dictionary": list(texts), "page_checksum_verification": True}
    with pq.ParquetFile(path, **options) as parquet:
        # One group at a time: Arrow does not join the dictionaries of lists of texts.
        groups = [parquet.read_row_group(i, list(names), use_threads=False) for i in range(parquet.num_row_groups)]
        table = pa.concat_tables(groups) if groups else pa.Table.from_batches([], parquet.schema_arrow)
    return table.select(list(names))


def _leaves(type_: Any) -> int:
    if isinstance(type_, pa.BaseExtensionType):
        return _leaves(type_.storage_type)
    if pa.types.is_map(type_):
        return _leaves(type_.key_type) + _leaves(type_.item_type)
    if is_list(type_) or pa.types.is_dictionary(type_):
        return _leaves(type_.value_type)
    if pa.types.is_struct(type_):
        return sum(_leaves(field_.type) for field_ in type_)
    return 1


def _values_per_leaf(metadata: Any) -> list[int]:
    """How many values each column holds according to the footer; an empty list counts as one."""
    groups = [metadata.row_group(i) for i in range(metadata.num_row_groups)]
    if sum(group.num_rows for group in groups) != metadata.num_rows:
        raise ValueError("the row groups do not have as many rows as the file")
    return [sum(group.column(i).num_values for group in groups) for i in range(metadata.num_columns)]


def _size(parquet: Any) -> NDArray[np.int64]:
    """Rows, numbers and texts of the longest columns, and bytes of a file when unpacked, by what its footer says."""
    metadata, schema = parquet.metadata, parquet.schema
    texts, numbers = [0], [0]
    for i, count in enumerate(_values_per_leaf(metadata)):
        (texts if _is_text(schema.column(i)) else numbers).append(count)
    unpacked = sum(metadata.row_group(i).total_byte_size for i in range(metadata.num_row_groups))
    return np.array([metadata.num_rows, max(numbers), max(texts), unpacked])


def _too_big(path: Path, sizes: Sequence[NDArray[np.int64]]) -> list[str]:
    """Refuse files that would be too big together when unpacked."""
    rows, numbers, texts, unpacked = (int(number) for number in np.sum(sizes, axis=0))
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


def _count(values: Any) -> int:
    """How many values a column holds, as Parquet counts them: an empty or missing list is one."""
    if isinstance(values.type, pa.BaseExtensionType):  # numbers of a tensor
        return sum(len(chunk.storage.flatten()) for chunk in values.chunks)
    if not is_list(values.type):
        return len(values)
    return pc.sum(pc.max_element_wise(pc.list_value_length(values), 1)).as_py() or 0


def _longest_text(values: Any) -> int:
    """Bytes of the longest text of a column; 0 for any other column."""
    longest = 0
    for chunk in values.chunks:
        inner = chunk.values if is_list(chunk.type) else chunk
        if pa.types.is_dictionary(inner.type):
            inner = inner.dictionary
        if holds_text(inner.type):
            longest = max(longest, pc.max(pc.binary_length(inner.cast(pa.large_binary()))).as_py() or 0)
    return longest
