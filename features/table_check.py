"""Find every breach of the feature table's contract in its values. Rows are counted from 0."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.limits import WORD_RULE, is_word
from features.size_limits import MAX_NUMBER, MAX_VECTOR_LENGTH
from features.table_columns import EXPECTED, FILES, Column, Words
from features.table_values import nulls, numbers

MAX_ROWS_NAMED = 20
"""Number of rows named for one breach of one column; the rest are counted."""
COLOR_SUM_TOLERANCE = 1e-6
"""How far the sum of a color histogram may be from 1."""


def problems_of_tables(
    files: tuple[Path, Path], trials: Any, objects: Any, *, need_attention: bool, words: Words | None = None
) -> list[str]:
    """Find every breach of the contract in the values of two Arrow tables that `conform` has made.

    Args:
        files: Names of the trials and of the objects file, for the messages.
        trials: Table of the trials; None when it could not be read.
        objects: Table of the objects; None when it could not be read.
        need_attention: Whether `attended_object` must be known in every trial.
        words: The experiment's words of each channel; None to accept any.

    Returns:
        One message per breach, with file, column, row and what is expected.
    """
    problems: list[str] = []
    for file, table, columns in zip(files, (trials, objects), FILES.values(), strict=True):
        if table is None:
            continue
        if table.num_columns and not table.num_rows:
            problems.append(f"{file}: has no rows; expected at least one")
        for column in columns:
            if column.name in table.column_names:
                values = table.column(column.name).combine_chunks()
                problems += _column_problems(_Place(file, column.name), column, values, words)
    return [*problems, *_relation_problems(files, trials, objects, need_attention)]


@dataclass(frozen=True)
class _Place:
    """A column of a file."""

    file: Path
    column: str

    def __str__(self) -> str:
        return f"{self.file}: column {self.column!r}"

    def at(self, rows: Iterable[Any], describe: Callable[[int], str]) -> Iterator[str]:
        """One message per row, and a last one that counts the rows beyond `MAX_ROWS_NAMED`."""
        numbers = [int(row) for row in rows]
        yield from (f"{self}, row {row}: {describe(row)}" for row in numbers[:MAX_ROWS_NAMED])
        if len(numbers) > MAX_ROWS_NAMED:
            yield f"{self}: the same in {len(numbers) - MAX_ROWS_NAMED} more rows"


def _column_problems(place: _Place, column: Column, values: Any, words: Words | None) -> Iterator[str]:
    """Problems of one column by itself."""
    null = nulls(values)
    if not column.nullable:
        yield from place.at(np.flatnonzero(null), lambda row: f"is null; expected {EXPECTED[column.kind]}")
    if column.kind == "vector":
        yield from _vector_problems(place, column, values, null)
    if column.kind in ("text", "words"):
        allowed = _allowed_words(column, words)
        rows = values.to_pylist()
        sentences = [row if column.kind == "words" else [row] for row in rows]
        unknown = " (null where it is not known)" if column.kind == "text" else ""
        bad = {row: text + unknown * (rows[row] == "")
               for row, sentence in enumerate(sentences) if rows[row] is not None
               for text in [_word_problem(sentence, allowed)] if text}  # fmt: skip
        yield from place.at(bad, bad.__getitem__)


def _allowed_words(column: Column, words: Words | None) -> Sequence[str] | None:
    """The words that a text or a sentence may hold; None for any."""
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


def _vector_problems(place: _Place, column: Column, values: Any, null: NDArray[np.bool_]) -> Iterator[str]:
    """Length, finiteness and, for a histogram, sign and sum of every vector that is not null."""
    lengths = numbers(values.value_lengths(), 0)
    known = lengths[~null]
    if known.size == 0:
        return
    usual = column.length or max(1, int(np.bincount(known).argmax()))
    source = "" if column.length else ", as in most rows" if np.any(known == usual) else " or more"
    if usual > MAX_VECTOR_LENGTH:
        yield f"{place}: {usual:,} numbers per row; at most {MAX_VECTOR_LENGTH:,}"
    flat = values.flatten()  # leaves out what stands behind null lists
    row_of = np.repeat(np.arange(len(lengths)), lengths)
    number = numbers(flat, np.nan)

    def in_row(flag: NDArray[np.bool_]) -> NDArray[np.bool_]:
        return np.bincount(row_of[flag], minlength=len(lengths)) > 0

    missing, unusable = in_row(nulls(flat)), in_row(~np.isfinite(number))
    huge = in_row(np.abs(np.nan_to_num(number, posinf=0, neginf=0)) > MAX_NUMBER)
    breaches: list[tuple[NDArray[np.bool_], Callable[[int], str]]] = [
        (~null & (lengths != usual), lambda row: f"has {lengths[row]} numbers; expected {usual}{source}"),
        (missing, lambda row: "holds a null; expected numbers"),
        (unusable & ~missing, lambda row: "holds nan or infinity; expected finite numbers"),
        (huge, lambda row: f"holds a number beyond ±{MAX_NUMBER:g}"),
    ]
    if column.histogram:
        total = np.bincount(row_of, weights=np.nan_to_num(number), minlength=len(lengths))
        wrong = (np.abs(total - 1) > COLOR_SUM_TOLERANCE) & (lengths > 0) & ~unusable
        breaches += [
            (in_row(number < 0), lambda row: "holds a negative number; expected 0 to 1"),
            (wrong, lambda row: f"sums to {total[row]:.9g}; expected 1{_unit(np.asarray(total[wrong], np.float64))}"),
        ]
    for rows, describe in breaches:
        yield from place.at(np.flatnonzero(rows), describe)


def _unit(total: NDArray[np.float64]) -> str:
    """What histograms seem to count that do not sum to 1, and what helps."""
    if np.all(np.abs(total - 100) < 1):
        return " (per cent? divide each by 100)"
    if np.all(np.abs(total - 255) < 2):
        return " (of 255? divide each by 255)"
    return " (counts? divide each histogram by its sum)" if np.all(total > 2) else ""


Keys = Sequence[Any]
"""A column of integers, or pairs of two, row by row; None where a row has none."""


def _relation_problems(files: tuple[Path, Path], trials: Any, objects: Any, need_attention: bool) -> Iterator[str]:
    """Problems between the files: keys and attention."""
    columns = ((trials, "trial"), (trials, "attended_object"), (objects, "trial"), (objects, "object"))
    known: list[Any] = [
        table.column(name).to_pylist() if table is not None and name in table.column_names else None
        for table, name in columns
    ]
    trial, attended, owner, index = known
    if trial is not None:
        yield from _Place(files[0], "trial").at(_repeats(trial), lambda row: "repeats an earlier trial")
    if trial is not None and owner is not None:
        yield from _Place(files[1], "trial").at(
            _alone(owner, trial), lambda row: f"trial {owner[row]} is not in {files[0]}"
        )
        yield from _Place(files[0], "trial").at(
            _alone(trial, owner), lambda row: f"trial {trial[row]} has no object in {files[1]}"
        )
    if owner is not None and index is not None:
        yield from _object_problems(_Place(files[1], "object"), owner, index)
    if attended is not None:
        place = _Place(files[0], "attended_object")
        if need_attention:
            unknown = (row for row, value in enumerate(attended) if value is None)
            yield from place.at(unknown, lambda row: "is null; expected the attended object")
        negative = (row for row, value in enumerate(attended) if value is not None and value < 0)
        yield from place.at(negative, lambda row: f"is {attended[row]}; expected 0 or more, or null")
        if trial is not None and owner is not None:
            counts = Counter(own for own in owner if own is not None)
            beyond = [
                row
                for row, (own, value) in enumerate(zip(trial, attended, strict=True))
                if value is not None and own in counts and value >= counts[own]
            ]
            yield from _outside(place, beyond, attended, trial, counts)


def _alone(keys: Keys, others: Keys) -> list[int]:
    """The rows with a key that the others do not have."""
    alone = set(keys) - {*others, None}
    return [row for row, key in enumerate(keys) if key in alone]


def _repeats(keys: Keys) -> list[int]:
    """The rows with a key that an earlier row has."""
    first = {key: row for row, key in reversed(list(enumerate(keys)))}
    return [row for row, key in enumerate(keys) if key is not None and first[key] != row]


def _object_problems(place: _Place, owner: Keys, index: Keys) -> Iterator[str]:
    """Each (trial, object) once, the objects of a trial 0 to M − 1."""
    keys = [None if None in key else key for key in zip(owner, index, strict=True)]
    repeated = set(_repeats(keys))
    yield from place.at(sorted(repeated), lambda row: f"repeats object {index[row]} of trial {owner[row]}")
    counts = Counter(key[0] for key in set(keys) if key is not None)
    outside = [
        row for row, key in enumerate(keys) if key and row not in repeated and not 0 <= key[1] < counts[key[0]]
    ]
    yield from _outside(place, outside, index, owner, counts)


def _outside(
    place: _Place, rows: Sequence[int], index: Keys, trial: Keys, counts: Mapping[int, int]
) -> Iterator[str]:
    """Objects that a trial does not have."""
    yield from place.at(
        rows,
        lambda row: (
            f"is {index[row]}, but trial {trial[row]} has {counts[trial[row]]} objects; "
            f"expected 0 to {counts[trial[row]] - 1}"
        ),
    )
