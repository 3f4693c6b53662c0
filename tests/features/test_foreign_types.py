"""Tables as other programs write them: what loses nothing is converted and told, the rest is refused by name."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet as pq
import pytest

from features import foreign_tables, table_files
from features.table import FeatureTable, TableError, import_table, import_with_notes
from features.table_columns import FILES as COLUMNS
from features.table_rounding import mend_rounding
from tests.features.test_table import VOCABULARY, arrow, save, valid


@pytest.fixture(autouse=True)
def _read_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        foreign_tables,
        "load_apart",
        lambda paths: {key: table_files.load(path, COLUMNS[key]) for key, path in paths.items()},
    )


def tables() -> dict[str, Any]:
    return {file: arrow(columns, file) for file, columns in valid().items()}


def changed(folder: Path, file: str, column: str, values: Any) -> tuple[Path, Path]:
    made = tables()
    made[file] = made[file].set_column(made[file].column_names.index(column), column, values)
    return save(folder, made)


def imported(paths: tuple[Path, Path]) -> tuple[FeatureTable, list[str]]:
    return import_with_notes(*paths, words=VOCABULARY, need_attention=True)


def same(table: FeatureTable, other: FeatureTable) -> None:
    for name, value in vars(other).items():
        np.testing.assert_array_equal(np.asarray(getattr(table, name), dtype=object), np.asarray(value, dtype=object))


def tensor(rows: Any) -> Any:
    return pa.ExtensionArray.from_storage(
        pa.fixed_shape_tensor(pa.float64(), [3]), pa.array(rows, pa.list_(pa.float64(), 3))
    )


TRIALS, OBJECTS = valid()["trials"], valid()["objects"]
ALIKE: dict[str, tuple[str, str, Any, str]] = {
    "whole doubles": ("trials", "attended_object", pa.array([1.0, 0.0, 0.0]), "of double is read as whole numbers"),
    "whole single precision": ("objects", "object", pa.array(OBJECTS["object"], pa.float32()), "whole numbers"),
    "decimals": ("trials", "trial", pa.array([Decimal("7.00"), Decimal("2.00"), Decimal("5.00")]), "whole numbers"),
    "texts as bytes": ("trials", "truth_action", pa.array([b"grasp", b"reach", None]), ""),
    "words as bytes": ("trials", "words", pa.array([[b"red", b"grasp"], [], [b"left"]]), ""),
    "view of words": ("trials", "words", pa.array(TRIALS["words"], pa.list_view(pa.string_view())), ""),
    "view of numbers": ("trials", "action", pa.array(TRIALS["action"], pa.large_list_view(pa.float64())), ""),
    "tensor": ("trials", "action", tensor(TRIALS["action"]), ""),
}  # fmt: skip


@pytest.mark.parametrize("name", ALIKE)
def test_other_types_of_the_same_content_read_alike(tmp_path: Path, name: str) -> None:
    expected, none = imported(save(tmp_path, tables()))
    assert none == []
    file, column, values, says = ALIKE[name]
    table, notes = imported(changed(tmp_path, file, column, values))
    same(table, expected)
    assert [says in note and column in note for note in notes] == ([True] if says else [])


@pytest.mark.parametrize(
    ("values", "numbers"),
    [([[1, 0, 0]] * 3, [1.0, 0.0, 0.0]), ([[True, False]] * 3, [1.0, 0.0]), ([[Decimal("0.25")]] * 3, [0.25])],
    ids=["integers", "booleans", "decimals"],
)
def test_vectors_of_other_numbers_are_read(tmp_path: Path, values: Any, numbers: list[float]) -> None:
    table, (note,) = imported(changed(tmp_path, "trials", "action", pa.array(values)))
    assert table.action.tolist() == [numbers] * 3
    assert "is read as numbers of double precision" in note


def test_nan_is_a_missing_number_or_word(tmp_path: Path) -> None:
    made = tables()
    made["trials"] = made["trials"].set_column(1, "attended_object", pa.array([1.0, float("nan"), 0.0]))
    made["objects"] = made["objects"].set_column(5, "truth_position", pa.array([float("nan")] * 5))
    table = import_table(*save(tmp_path, made), need_attention=False)
    assert table.attended_object.tolist() == [-1, 0, 1]
    assert table.truth_position is None


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("file", "column", "values", "says"),
    [
        ("trials", "trial", pa.array([7.0, 2.5, 5.0]), "row 1: is 2.5; expected a whole number"),
        ("trials", "trial", pa.array([7.0, 2.0**60, 5.0]), "row 1: is 1.15"),
        ("objects", "object", pa.array([1.0, float("inf"), 1.0, 0.0, 0.0]), "row 1: is inf; expected a whole number"),
        ("trials", "trial", pa.array([Decimal("7.5"), Decimal("2.0"), Decimal("5.0")]), "expected int64"),
        ("trials", "truth_action", pa.array([b"\xff", b"reach", None]), "expected string"),
        ("trials", "truth_action", pa.array([float("nan"), 1.0, None]), "row 1: is 1.0; expected text"),
        ("trials", "words", pa.array(["red grasp", "", "left"]), "text.split()"),
    ],
    ids=["fraction", "beyond double", "infinity", "decimal", "no UTF-8", "number for a word", "sentence as a text"],
)  # fmt: skip
def test_what_would_lose_something_is_refused(tmp_path: Path, file: str, column: str, values: Any, says: str) -> None:
    with pytest.raises(TableError) as refused:
        imported(changed(tmp_path, file, column, values))
    assert any(says in problem and f"column {column!r}" in problem for problem in refused.value.problems)


def test_other_columns_are_passed_over_with_a_note(tmp_path: Path) -> None:
    made = tables()
    made["trials"] = made["trials"].append_column("words.x", pa.array([1] * 3))
    made["trials"] = made["trials"].append_column("__index_level_0__", pa.array([3, 4, 5]))
    made["objects"] = made["objects"].rename_columns({"truth_color": "truth_colour"})
    table, notes = imported(save(tmp_path, made))
    assert table.truth_color is None
    assert [note.partition(": ")[2] for note in notes] == [
        "column is passed over, which no table has: 'words.x'",
        "column 'truth_colour' is passed over; did you mean 'truth_color'?",
    ]


@pytest.mark.bad_input
def test_a_column_that_is_called_almost_so_is_named(tmp_path: Path) -> None:
    made = tables()
    made["objects"] = made["objects"].rename_columns({"color": "colour"})
    with pytest.raises(TableError, match=r"column 'color' is missing; .* \(rename column 'colour'\?\)"):
        imported(save(tmp_path, made))


def test_pandas_after_a_filter_and_with_an_index(tmp_path: Path) -> None:
    expected, _ = imported(save(tmp_path, tables()))
    trials, objects = pd.DataFrame(TRIALS), pd.DataFrame(OBJECTS)
    trials[trials.trial > 0].sample(frac=1, random_state=1).to_parquet(tmp_path / "trials.parquet")
    objects.set_index(["trial", "object"]).to_parquet(tmp_path / "objects.parquet")
    table, notes = imported((tmp_path / "trials.parquet", tmp_path / "objects.parquet"))
    same(table, expected)
    assert notes == []


def test_an_index_that_only_counts_is_a_column(tmp_path: Path) -> None:
    made = tables()
    made["objects"] = made["objects"].filter(pa.array([True, True, False, False, True]))
    trials = pd.DataFrame(TRIALS).iloc[1:].drop(columns="trial").set_index(pd.RangeIndex(2, 6, 3, name="trial"))
    save(tmp_path, made)
    trials.to_parquet(tmp_path / "trials.parquet")
    table, _ = imported((tmp_path / "trials.parquet", tmp_path / "objects.parquet"))
    assert table.trial.tolist() == [2, 5]


ENCODINGS = {
    "delta": {"use_dictionary": False, "column_encoding": {"words.list.element": "DELTA_BYTE_ARRAY"}},
    "delta length": {"use_dictionary": False, "column_encoding": {"truth_action": "DELTA_LENGTH_BYTE_ARRAY"}},
    "stream split": {"use_dictionary": False, "column_encoding": {"action.list.element": "BYTE_STREAM_SPLIT"}},
    "lists of old": {"use_compliant_nested_type": False},
}


@pytest.mark.parametrize("name", ENCODINGS)
def test_every_encoding_reads_alike(tmp_path: Path, name: str) -> None:
    trials, objects = save(tmp_path, tables())
    expected, _ = imported((trials, objects))
    pq.write_table(tables()["trials"], trials, **ENCODINGS[name])
    same(imported((trials, objects))[0], expected)


def test_a_footer_may_be_large(tmp_path: Path) -> None:
    trials, objects = save(tmp_path, tables())
    expected, _ = imported((trials, objects))
    pq.write_table(tables()["trials"].replace_schema_metadata({"notes": "x" * 120_000_000}), trials)
    same(imported((trials, objects))[0], expected)


def in_parts(table: Any, folder: Path) -> None:
    folder.mkdir()
    pq.write_table(table[:1], folder / "part-00000.snappy.parquet")
    pq.write_table(table[1:].drop_columns(["truth_action"]), folder / "part-00001.snappy.parquet")
    pq.write_table(pa.table({"trial": pa.nulls(0)}), folder / "part-00002.snappy.parquet")
    (folder / "_SUCCESS").touch()
    (folder / ".part-00000.snappy.parquet.crc").write_bytes(b"crc")


def by_trial(table: Any, folder: Path) -> None:
    pyarrow.dataset.write_dataset(table, folder, format="parquet", partitioning=["trial"], partitioning_flavor="hive")


@pytest.mark.parametrize(
    ("write", "truth"), [(in_parts, (None, None, "grasp")), (by_trial, ("reach", None, "grasp"))]
)
def test_a_folder_of_parts_is_a_table(tmp_path: Path, write: Callable[[Any, Path], None], truth: Any) -> None:
    trials, objects = save(tmp_path, tables())
    trials.unlink()
    write(tables()["trials"], trials)
    table, _ = imported((trials, objects))
    assert table.trial.tolist() == [2, 5, 7]
    assert table.truth_action == truth


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("content", "says"),
    [(b"trial,words,a,b\n1,red,2,3\n", "CSV"), (b"ARROW1\0\0", "Feather"), (b"PK\x03\x04", "Excel"),
     (b"version https://git-lfs.github.com/spec/v1\n", "Git LFS")],
    ids=["csv", "feather", "excel", "pointer"],
)  # fmt: skip
def test_what_another_file_is_is_said(tmp_path: Path, content: bytes, says: str) -> None:
    trials, objects = save(tmp_path, tables())
    trials.write_bytes(content)
    with pytest.raises(TableError, match=f"not a Parquet file, .*{says}"):
        imported((trials, objects))


def test_parts_are_too_big_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trials, _ = save(tmp_path, tables())
    trials.unlink()
    in_parts(tables()["trials"], trials)
    monkeypatch.setattr(table_files, "MAX_TABLE_ROWS", 2)
    assert "holds 3 rows" in table_files.load(trials, COLUMNS["trials"]).problems[0]


def colors(make: Callable[[np.ndarray], Any], bins: int = 10) -> list[Any]:
    rng = np.random.default_rng(1)
    return [np.asarray(make(rng.dirichlet(np.ones(bins))), dtype=float).tolist() for _ in range(5)]


def softmax(kind: Any) -> Callable[[np.ndarray], Any]:
    def of(shares: np.ndarray) -> Any:
        powers = np.exp(np.log(shares).astype(kind))
        return powers / powers.sum()

    return of


ROUNDED = {
    "4 digits": colors(lambda shares: np.round(shares, 4)),
    "2 digits": colors(lambda shares: np.round(shares, 2)),
    "4 digits in single precision": colors(lambda shares: np.round(shares, 4).astype(np.float32)),
    "half precision": colors(lambda shares: shares.astype(np.float16)),
    "softmax in half precision": colors(softmax(np.float16)),
    "softmax in single precision": colors(softmax(np.float32), 256),
    "noise below 0": [[1.0, -1e-17, 0.0]] * 5,
}


@pytest.mark.parametrize("name", ROUNDED)
def test_what_rounding_explains_sums_to_1_again(tmp_path: Path, name: str) -> None:
    values = ROUNDED[name]
    table, notes = imported(changed(tmp_path, "objects", "color", pa.array(values)))
    np.testing.assert_allclose(table.color.sum(axis=1), 1, atol=1e-6)
    assert table.color.min() >= 0
    np.testing.assert_allclose(np.sort(table.color, axis=0), np.sort(values, axis=0), atol=0.02)
    assert [("divided by their sum" in note) for note in notes] == (
        [] if name.endswith("single precision") and "softmax" in name else [True]
    )


EXPLAINED = {
    "per cent": (colors(lambda shares: 100 * shares), "per cent"),
    "counts": (colors(lambda shares: np.round(500 * shares)), "counts"),
    "bytes": (colors(lambda shares: 255 * shares), "255"),
    "a bin lost": (colors(lambda shares: np.round(shares * [0, *[1] * 9], 4)), "expected 1"),
    "off in full precision": (colors(lambda shares: shares * 1.0001), "expected 1"),
    "negative": ([[1.001, -0.001]] * 5, "negative"),
}


@pytest.mark.bad_input
@pytest.mark.parametrize("name", EXPLAINED)
def test_what_rounding_does_not_explain_is_refused(tmp_path: Path, name: str) -> None:
    values, says = EXPLAINED[name]
    with pytest.raises(TableError, match=says):
        imported(changed(tmp_path, "objects", "color", pa.array(values)))


def test_what_sums_to_1_keeps_its_bits() -> None:
    values = pa.array(colors(lambda shares: shares), pa.list_(pa.float64()))
    mended, note = mend_rounding(values)
    assert mended is values
    assert note == ""


def test_words_are_compared_in_one_normal_form(tmp_path: Path) -> None:
    word = "tröckën"
    made = tables()
    apart = unicodedata.normalize("NFD", word)
    made["trials"] = made["trials"].set_column(2, "words", pa.array([["red", apart], [], [word]]))
    made["objects"] = made["objects"].set_column(7, "truth_color", pa.array([apart, None, word, "red", apart]))
    words = {**VOCABULARY, "color": ["red", word]}
    table, _ = import_with_notes(*save(tmp_path, made), words=words, need_attention=True)
    assert table.words == ((), (word,), ("red", word))
    assert set(table.truth_color or ()) == {word, "red", None}
