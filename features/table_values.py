"""The values of Arrow columns as NumPy and Python have them, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from features.table_columns import EXPECTED, Column


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


def values_of(table: Any, column: Column) -> Any:
    """A column of an Arrow table as `FeatureTable` holds it; None for a text column that is absent or all null."""
    if column.name not in table.column_names:
        return None
    stored = table[column.name].combine_chunks()
    match column.kind:
        case "integer":
            return numbers(stored, -1)
        case "vector":
            return numbers(stored.flatten(), np.nan).reshape(len(stored), -1)
        case "words":
            return tuple(tuple(sentence) for sentence in stored.to_pylist())
        case "text":
            return None if stored.null_count == len(stored) else tuple(stored.to_pylist())


def stored(values: Any, column: Column) -> Any:
    """Values of a `FeatureTable` as an Arrow array; the inverse of `values_of`."""
    missing = values < 0 if column.kind == "integer" and column.nullable else None
    values = values if column.kind == "integer" else list(values)
    return pa.array(values, EXPECTED[column.kind], mask=missing)
