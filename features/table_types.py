"""Bring the columns of an Arrow table into the types of the contract, wherever nothing is lost by it.

Other programs write the same content otherwise: any width of numbers, whole numbers as doubles beside missing values,
texts as bytes or dictionaries, lists of any kind, an index apart from the columns. The rest is reported by name.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence
from typing import Any

import pyarrow as pa
import pyarrow.compute as pc

from data_collection.limits import normal
from features.table_columns import EXPECTED, Column

MAX_NAMED = 20
"""So many rows of one column are named, or columns of one file; the rest are counted."""
HINTS = {
    "words": "a list of words for each row, such as text.split() makes of a sentence",
    "vector": "a list of numbers for each row",
    "integer": "whole numbers",
    "text": "a word for each row",
}


def is_list(type_: Any) -> bool:
    """Whether an Arrow type is a list of any kind."""
    kinds = ("list", "large_list", "fixed_size_list", "list_view", "large_list_view")
    return any(getattr(pa.types, f"is_{kind}")(type_) for kind in kinds)


def holds_text(type_: Any) -> bool:
    """Whether values of an Arrow type may be texts: bytes are, where they are UTF-8."""
    type_ = type_.value_type if pa.types.is_dictionary(type_) else type_
    kinds = ("string", "large_string", "string_view", "binary", "large_binary", "binary_view")
    return any(getattr(pa.types, f"is_{kind}")(type_) for kind in kinds)


def _holds_numbers(type_: Any) -> bool:
    type_ = type_.value_type if pa.types.is_dictionary(type_) else type_
    return any(test(type_) for test in (pa.types.is_integer, pa.types.is_floating, pa.types.is_decimal))


def _fits(type_: Any, column: Column) -> bool:
    """Whether an Arrow type may hold the column's kind without loss."""
    if isinstance(type_, pa.BaseExtensionType):
        return _fits(type_.storage_type, column)
    if pa.types.is_null(type_):
        return column.nullable
    if column.kind == "integer":
        return _holds_numbers(type_)
    if column.kind == "text":  # a column without any text is one of NaN in pandas
        return holds_text(type_) or (column.nullable and pa.types.is_floating(type_))
    if not is_list(type_):
        return False
    inner = type_.value_type
    if column.kind == "vector":
        return _holds_numbers(inner) or pa.types.is_boolean(inner)
    # A file whose sentences are all empty has no type of word.
    return pa.types.is_null(inner) or holds_text(inner)


def fitting(
    file: str, schema: Any, columns: Sequence[Column], restored: Sequence[str] = ()
) -> tuple[list[Column], list[str], list[str]]:
    """The ones of `columns` that a schema has in a fitting type, what is wrong with the others, what is passed over.

    Args:
        file: Its name, for the messages.
        schema: The Arrow schema.
        columns: Those of the contract.
        restored: The names of those that are known without standing in the schema.
    """
    names = [column.name for column in columns]
    others = [name for name in dict.fromkeys(schema.names) if name not in names]
    usable, problems = [], []
    for column in columns:
        count = schema.names.count(column.name)
        where, expected = f"{file}: column {column.name!r}", EXPECTED[column.kind]
        if column.name in restored:
            usable.append(column)
        elif count > 1:
            problems.append(f"{where} occurs {count} times; expected once")
        elif count == 0 and column.required:
            alike = difflib.get_close_matches(column.name, others, n=1)
            hint = f" (rename column {alike[0]!r}?)" if alike else ""
            problems.append(f"{where} is missing; expected {expected}{hint}")
        elif count == 1 and not _fits(type_ := schema.field(column.name).type, column):
            problems.append(f"{where} has type {type_}; expected {expected} ({HINTS[column.kind]})")
        elif count == 1:
            usable.append(column)
    missing = [name for name in names if name not in schema.names]
    return usable, problems, _passed_over(file, others, missing)


def _passed_over(file: str, others: Sequence[str], missing: Sequence[str]) -> list[str]:
    """What is said of columns that the contract does not know; almost the name of a missing one stands out."""
    likely = {name: difflib.get_close_matches(name.lower(), missing, n=1, cutoff=0.8) for name in others}
    notes = [
        f"{file}: column {name!r} is passed over; did you mean {near[0]!r}?" for name, near in likely.items() if near
    ]
    plain = [
        repr(name) for name, near in likely.items() if not near and not re.fullmatch(r"__index_level_\d+__", name)
    ]
    if plain:
        more = f" and {len(plain) - MAX_NAMED} more" if len(plain) > MAX_NAMED else ""
        word = "columns are" if len(plain) > 1 else "column is"
        notes.append(f"{file}: {word} passed over, which no table has: {', '.join(plain[:MAX_NAMED])}{more}")
    return notes


def conform(file: str, table: Any, columns: Sequence[Column]) -> tuple[Any, list[str], list[str]]:
    """Keep the usable ones of `columns` in the types of the contract.

    Returns:
        The table, what is wrong with the other columns, and what was converted.
    """
    usable, problems, _ = fitting(file, table.schema, columns)
    notes: list[str] = []
    kept = {}
    for column in usable:
        where, expected = f"{file}: column {column.name!r}", EXPECTED[column.kind]
        stored = table.column(column.name)
        if stored.type == expected:
            kept[column.name] = _normal(pa.concat_arrays(stored.chunks or [pa.array([], expected)]))
            continue
        try:
            chunks = [_converted(chunk, column) for chunk in stored.chunks]
            kept[column.name] = _normal(pa.concat_arrays(chunks or [pa.array([], expected)]))
        except _RowError as error:
            problems += [f"{where}, {line}" for line in error.args[0]]
        except (pa.ArrowInvalid, pa.ArrowNotImplementedError, UnicodeDecodeError) as error:
            problems.append(f"{where}: {str(error).splitlines()[0]}; expected {expected}")
        else:
            if told := _change(stored.type, column):
                notes.append(f"{where} {told}")
    return pa.table(kept), problems, notes


class _RowError(ValueError):
    """Values that cannot be converted; holds a line for each row."""


def _change(type_: Any, column: Column) -> str:
    """What to say of a conversion that a reader might not expect."""
    if column.kind == "integer" and not pa.types.is_integer(type_) and not pa.types.is_dictionary(type_):
        return f"of {type_} is read as whole numbers"
    if column.kind == "vector" and not pa.types.is_floating(type_.value_type):
        return f"of {type_} is read as numbers of double precision"
    return ""


def _converted(values: Any, column: Column) -> Any:
    """An Arrow array in the type of its column's kind.

    Raises:
        _RowError: Some values are no whole numbers.
        ArrowInvalid: Others do not fit.
    """
    if isinstance(values.type, pa.BaseExtensionType):
        values = values.storage
    expected = EXPECTED[column.kind]
    if pa.types.is_dictionary(values.type):
        values = values.dictionary_decode()
    if column.kind == "integer":
        return _whole(values)
    if column.kind == "text" and pa.types.is_floating(values.type):
        known = pc.and_kleene(pc.is_valid(values), pc.invert(pc.is_nan(values)))
        rows = [row for row, one in enumerate(known.to_pylist()) if one]
        if rows:
            raise _RowError([f"row {row}: is {values[row].as_py()}; expected text" for row in rows[:MAX_NAMED]])
        return pa.nulls(len(values), expected)
    if not is_list(values.type):
        return values.cast(expected)
    inner = values.flatten()
    inner = inner.dictionary_decode() if pa.types.is_dictionary(inner.type) else inner
    return _with_values(values, inner.cast(expected.value_type))


def _with_values(lists: Any, values: Any) -> Any:
    """A list array of the lengths of another one of any kind, with other values in place of its flattened ones."""
    lengths = pc.fill_null(pc.list_value_length(lists), 0).cast(pa.int32())
    offsets = pa.concat_arrays([pa.array([0], pa.int32()), pc.cumulative_sum(lengths)])
    return pa.ListArray.from_arrays(offsets, values, mask=lists.is_null())


def _whole(values: Any) -> Any:
    """Numbers as whole numbers; NaN is a missing one."""
    expected = EXPECTED["integer"]
    if pa.types.is_integer(values.type) or pa.types.is_null(values.type):
        return values.cast(expected)
    if pa.types.is_decimal(values.type):
        return values.cast(expected)  # refused where digits would be lost
    values = values.cast(pa.float64())
    values = pc.if_else(pc.fill_null(pc.is_nan(values), False), pa.scalar(None, pa.float64()), values)
    broken = pc.fill_null(pc.or_(pc.not_equal(pc.floor(values), values), pc.greater(pc.abs(values), 2.0**53)), False)
    rows = [row for row, one in enumerate(broken.to_pylist()) if one]
    if rows:
        lines = [f"row {row}: is {values[row].as_py()}; expected a whole number" for row in rows[:MAX_NAMED]]
        more = len(rows) - MAX_NAMED
        raise _RowError([*lines, f"the same in {more} more rows"] if more > 0 else lines)
    return values.cast(expected)


def _normal(values: Any) -> Any:
    """Texts in Unicode's normal form C, in which words are compared."""
    if pa.types.is_string(values.type):
        texts = values.to_pylist()
        if all(text is None or text.isascii() for text in texts):
            return values
        return pa.array([text and normal(text) for text in texts], values.type)
    if pa.types.is_list(values.type) and pa.types.is_string(values.type.value_type):
        inner = values.flatten()
        one_form = _normal(inner)
        return values if one_form is inner else _with_values(values, one_form)
    return values
