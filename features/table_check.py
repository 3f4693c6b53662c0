"""Find every breach of the feature table's contract in its values. Rows are counted from 0."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.limits import WORD_RULE, is_word
from features.size_limits import MAX_NUMBER, MAX_VECTOR_LENGTH
from features.table_columns import EXPECTED, FILES, Column
from features.table_files import nulls, numbers

MAX_ROWS_NAMED = 20
"""So many rows are named for one breach of one column; the rest is counted."""
COLOR_SUM_TOLERANCE = 1e-6
"""How far the sum of a color histogram may be from 1."""


def problems_of_tables(
    files: tuple[str, str],
    trials: Any,
    objects: Any,
    *,
    need_attention: bool,
    words: Mapping[str, Sequence[str]] | None = None,
) -> list[str]:
    """Find every breach of the contract in the values of two Arrow tables that `conform` has made.

    Args:
        files: Names of the trials and of the objects file, for the messages.
        trials: Table of the trials; None when it could not be read.
        objects: Table of the objects; None when it could not be read.
        need_attention: Whether `attended_object` must be known in every trial.
        words: The experiment's words of each channel; None to accept any.

    Returns:
        One message a breach, each with file, column, row and what is expected.
    """
    problems: list[str] = []
    for file, table, columns in zip(files, (trials, objects), FILES.values(), strict=True):
        if table is None:
            continue
        if table.num_columns and not table.num_rows:
            problems.append(f"{file}: has no rows; expected at least one")
        for column in columns:
            if column.name in table.column_names:
                problems += _column_problems(file, column, table.column(column.name).combine_chunks(), words)
    return problems + _relation_problems(files, trials, objects, need_attention)


def _at(file: str, column: str, rows: Iterable[Any], describe: Callable[[int], str]) -> list[str]:
    """One message a row, and a last one that counts the rows beyond `MAX_ROWS_NAMED`."""
    numbers = [int(row) for row in rows]
    lines = [f"{file}: column {column!r}, row {row}: {describe(row)}" for row in numbers[:MAX_ROWS_NAMED]]
    if len(numbers) > MAX_ROWS_NAMED:
        lines.append(f"{file}: column {column!r}: the same in {len(numbers) - MAX_ROWS_NAMED} more rows")
    return lines


def _column_problems(file: str, column: Column, values: Any, words: Mapping[str, Sequence[str]] | None) -> list[str]:
    """Problems of one column by itself."""
    null = nulls(values)
    problems = []
    if not column.nullable:
        what = f"is null; expected {EXPECTED[column.kind]}"
        problems += _at(file, column.name, np.flatnonzero(null), lambda row: what)
    if column.kind == "vector":
        problems += _vector_problems(file, column, values, null)
    if column.kind in ("text", "words"):
        allowed = _allowed_words(column, words)
        rows = values.to_pylist()
        sentences = [row if column.kind == "words" else [row] for row in rows]
        bad = {row: text for row, sentence in enumerate(sentences) if rows[row] is not None
               for text in [_word_problem(sentence, allowed)] if text}  # fmt: skip
        problems += _at(file, column.name, bad, bad.__getitem__)
    return problems


def _allowed_words(column: Column, words: Mapping[str, Sequence[str]] | None) -> Sequence[str] | None:
    """Give the words a text or a sentence may hold; None for any."""
    if words is None:
        return None
    if column.channel is not None:
        return tuple(words.get(column.channel, ()))
    return tuple(word for channel in words.values() for word in channel)


def _word_problem(sentence: Sequence[str | None], allowed: Sequence[str] | None) -> str:
    """Say what is wrong with a sentence; empty if nothing is."""
    if any(word is None for word in sentence):
        return "has a word that is null; expected text"
    if bad := [word for word in sentence if word is not None and not is_word(word)]:
        return f"{bad[0][:60]!r} is no word; expected {WORD_RULE}"
    unknown = [word for word in sentence if allowed is not None and word not in allowed]
    if unknown:
        return f"{', '.join(map(repr, unknown))} not among the experiment's words: {', '.join(allowed or ())}"
    return ""


def _vector_problems(file: str, column: Column, values: Any, null: NDArray[np.bool_]) -> list[str]:
    """Length, finiteness and, for a histogram, sign and sum of every vector that is not null."""
    lengths = numbers(values.value_lengths(), 0)
    known = lengths[~null]
    if known.size == 0:
        return []
    usual = column.length or max(1, int(np.bincount(known).argmax()))
    source = "" if column.length else ", as in most rows" if np.any(known == usual) else " or more"
    problems = _at(
        file, column.name, np.flatnonzero(~null & (lengths != usual)),
        lambda row: f"has {lengths[row]} numbers; expected {usual}{source}",
    )  # fmt: skip
    flat = values.flatten()  # leaves out what stands behind null lists
    row_of = np.repeat(np.arange(len(lengths)), lengths)
    number = numbers(flat, np.nan)

    def any_in_row(flag: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return np.bincount(row_of[flag], minlength=len(lengths)) > 0

    missing = any_in_row(nulls(flat))
    problems += _at(file, column.name, np.flatnonzero(missing), lambda row: "holds a null; expected numbers")
    unusable = any_in_row(~np.isfinite(number))
    problems += _at(
        file, column.name, np.flatnonzero(unusable & ~missing),
        lambda row: "holds nan or infinity; expected finite numbers",
    )  # fmt: skip
    huge = any_in_row(np.abs(np.nan_to_num(number, posinf=0, neginf=0)) > MAX_NUMBER)
    problems += _at(file, column.name, np.flatnonzero(huge), lambda row: f"holds a number beyond ±{MAX_NUMBER:g}")
    if usual > MAX_VECTOR_LENGTH:
        problems.append(f"{file}: column {column.name!r}: {usual:,} numbers a row; at most {MAX_VECTOR_LENGTH:,}")
    if column.histogram:
        negative = any_in_row(number < 0)
        problems += _at(
            file,
            column.name,
            np.flatnonzero(negative),
            lambda row: "holds a negative number; expected 0 to 1",
        )
        total = np.bincount(row_of, weights=np.nan_to_num(number), minlength=len(lengths))
        wrong = (np.abs(total - 1) > COLOR_SUM_TOLERANCE) & (lengths > 0) & ~unusable
        problems += _at(file, column.name, np.flatnonzero(wrong), lambda row: f"sums to {total[row]:.9g}; expected 1")
    return problems


def _integers(table: Any, name: str) -> tuple[NDArray[np.int64], NDArray[np.intp]] | None:
    """Known values of an integer column and the rows they are from; None without the column."""
    if table is None or name not in table.column_names:
        return None
    column = table.column(name).combine_chunks()
    return numbers(column.drop_null(), -1), np.flatnonzero(~nulls(column))


def _relation_problems(files: tuple[str, str], trials: Any, objects: Any, need_attention: bool) -> list[str]:
    """Keys of both files and the attention, against each other."""
    problems = []
    trial, owner, index = (
        _integers(trials, "trial"),
        _integers(objects, "trial"),
        _integers(objects, "object"),
    )
    if trial is not None:
        problems += _at(files[0], "trial", trial[1][_repeats(trial[0])], lambda row: "repeats an earlier trial")
    if trial is not None and owner is not None:
        unknown = owner[1][~np.isin(owner[0], trial[0])]
        name = objects.column("trial")
        problems += _at(files[1], "trial", unknown, lambda row: f"trial {name[row].as_py()} is not in {files[0]}")
        bare = trial[1][~np.isin(trial[0], owner[0])]
        problems += _at(
            files[0], "trial", bare,
            lambda row: f"trial {trials.column('trial')[row].as_py()} has no object in {files[1]}",
        )  # fmt: skip
    if owner is not None and index is not None:
        problems += _object_index_problems(files[1], objects)
    if trials is not None and "attended_object" in trials.column_names:
        problems += _attention_problems(files, trials, owner, need_attention)
    return problems


def _repeats(keys: NDArray[Any]) -> NDArray[np.bool_]:
    """Which rows of `keys` occur earlier."""
    first = np.unique(keys, axis=0, return_index=True)[1]
    repeated = np.ones(len(keys), dtype=bool)
    repeated[first] = False
    return repeated


def _object_index_problems(file: str, objects: Any) -> list[str]:
    """Each (trial, object) once, the objects of a trial 0 to M − 1."""
    owner = objects.column("trial").combine_chunks()
    index = objects.column("object").combine_chunks()
    rows = np.flatnonzero(~(nulls(owner) | nulls(index)))
    keys = np.stack([numbers(column, -1)[rows] for column in (owner, index)], axis=1)
    repeated = _repeats(keys)
    problems = _at(
        file, "object", rows[repeated],
        lambda row: f"repeats object {index[row].as_py()} of trial {owner[row].as_py()}",
    )  # fmt: skip
    distinct, inverse, count = np.unique(keys[~repeated, 0], return_inverse=True, return_counts=True)
    limit = count[inverse] if distinct.size else np.zeros(0, dtype=np.int64)
    outside = (keys[~repeated, 1] < 0) | (keys[~repeated, 1] >= limit)
    limits = dict(zip(rows[~repeated].tolist(), limit.tolist(), strict=True))
    return problems + _at(
        file, "object", rows[~repeated][outside],
        lambda row: f"is {index[row].as_py()}, but trial {owner[row].as_py()} has {limits[row]} objects; "
        f"expected 0 to {limits[row] - 1}",
    )  # fmt: skip


def _attention_problems(
    files: tuple[str, str],
    trials: Any,
    owner: tuple[NDArray[np.int64], NDArray[np.intp]] | None,
    need_attention: bool,
) -> list[str]:
    """Check that the attended object is known where it must be, and is one of the trial's objects."""
    attended = trials.column("attended_object").to_pylist()
    problems = []
    if need_attention:
        unknown = [row for row, value in enumerate(attended) if value is None]
        problems += _at(files[0], "attended_object", unknown, lambda row: "is null; expected the attended object")
    negative = [row for row, value in enumerate(attended) if value is not None and value < 0]
    problems += _at(
        files[0], "attended_object", negative, lambda row: f"is {attended[row]}; expected 0 or more, or null"
    )
    if owner is None or "trial" not in trials.column_names:
        return problems
    counts = dict(zip(*(part.tolist() for part in np.unique(owner[0], return_counts=True)), strict=True))
    trial = trials.column("trial").to_pylist()
    beyond = [row for row, value in enumerate(attended)
              if value is not None and trial[row] in counts and value >= counts[trial[row]]]  # fmt: skip
    return problems + _at(
        files[0], "attended_object", beyond,
        lambda row: f"is {attended[row]}, but trial {trial[row]} has {counts[trial[row]]} objects; "
        f"expected 0 to {counts[trial[row]] - 1}",
    )  # fmt: skip
