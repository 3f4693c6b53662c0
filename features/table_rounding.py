"""Histograms that sum to 1 but for the digits that their writer left out: what rounding explains, and what not."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from features.table_check import COLOR_SUM_TOLERANCE
from features.table_columns import Column
from features.table_files import Read
from features.table_values import nulls, numbers

DECIMALS = range(2, 8)
"""Decimals to which shares may have been rounded; of fewer, rounding would explain nearly everything."""
MOST_EXPLAINED = 0.05
"""More than this is no rounding, however many bins there are."""
_HALF, _SINGLE = np.finfo(np.float16), np.finfo(np.float32)
_STEPS = 4.0  # a sum of quotients has so many times the error of one number


def without_rounding(path: Path, read: Read, columns: Sequence[Column]) -> Read:
    """What was read, its histograms made to sum to 1 where rounding explains that they do not."""
    table, notes = read.table, list(read.notes)
    for column in columns:
        if table is None or not column.histogram or column.name not in table.column_names:
            continue
        mended, note = mend_rounding(table.column(column.name).combine_chunks())
        if note:
            table = table.set_column(table.column_names.index(column.name), column.name, mended)
            notes.append(f"{path}: column {column.name!r}: {note}")
    return Read(table, read.problems, notes)


def mend_rounding(values: Any) -> tuple[Any, str]:
    """Divide histograms by their sum where rounding explains that it is not 1; the others stay as they are.

    Args:
        values: Arrow list array of doubles, a histogram per row.

    Returns:
        The array, and what was done; nothing of an array that needs nothing.
    """
    lengths = numbers(values.value_lengths(), 0)
    flat = numbers(values.flatten(), np.nan)
    if not len(flat) or nulls(values).any() or not np.isfinite(flat).all():
        return values, ""
    row_of = np.repeat(np.arange(len(lengths)), lengths)
    allowed, noise = _explained(flat, lengths)
    total = np.bincount(row_of, weights=flat, minlength=len(lengths))
    lowest = np.zeros(len(lengths))
    np.minimum.at(lowest, row_of, flat)
    off = (np.abs(total - 1) > COLOR_SUM_TOLERANCE) | (lowest < 0)
    mended = off & (np.abs(total - 1) <= np.maximum(allowed, COLOR_SUM_TOLERANCE)) & (lowest >= -noise)
    if not mended.any():
        return values, ""
    positive = np.maximum(flat, 0)
    sums = np.bincount(row_of, weights=positive, minlength=len(lengths))
    new = np.where(mended[row_of], positive / np.where(sums > 0, sums, 1)[row_of], flat)
    worst = float(np.max(np.abs(total - 1)[mended]))
    starts = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)
    note = (
        f"{int(mended.sum())} of {len(lengths)} rows are divided by their sum, which rounding left at 1 ± {worst:.1g}"
    )
    return pa.ListArray.from_arrays(pa.array(starts), pa.array(new)), note


def _explained(flat: NDArray[np.float64], lengths: NDArray[np.int64]) -> tuple[NDArray[np.float64], float]:
    """By how much rounding may have moved the sum of each row, and how far below 0 it may have left a number.

    The precision is that of the whole column: the fewest decimals, or bits, with which all numbers can be written.
    """
    noise = _STEPS * float(np.finfo(np.float64).eps) * max(int(lengths.max()), 1)
    allowed: NDArray[np.floating[Any]] = np.zeros(len(lengths))
    with np.errstate(over="ignore"):
        half, single = flat.astype(np.float16) == flat, flat.astype(np.float32) == flat
    if half.all():
        allowed = _STEPS * float(_HALF.eps) * np.ones(len(lengths), np.float64)
    elif single.all():
        allowed = _STEPS * float(_SINGLE.eps) * lengths
        noise = _STEPS * float(_SINGLE.eps)
    # Decimals may have been stored with the bits of single precision.
    near = np.maximum(1e-12, (float(_SINGLE.eps) if single.all() else 0) * np.abs(flat))
    decimals = next((d for d in DECIMALS if (np.abs(np.round(flat, d) - flat) <= near).all()), None)
    if decimals is not None:
        allowed = np.maximum(allowed, 0.5 * 10.0**-decimals * lengths * (1 + 1e-9))
    return np.minimum(allowed, MOST_EXPLAINED).astype(np.float64), noise
