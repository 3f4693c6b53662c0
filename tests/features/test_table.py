"""The contract of the two Parquet files: what is accepted, and every breach of it, each by name."""

import hashlib
import operator
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from features import foreign_tables, table_columns, table_files, table_parts
from features.table import (
    FeatureTable,
    TableError,
    check_table,
    head,
    read_metadata,
    read_table,
    write_table,
)
from features.table_check import MAX_ROWS_NAMED
from features.table_columns import FILES as COLUMNS

INTEGERS, TEXT, WORDS, VECTOR = pa.int64(), pa.string(), pa.list_(pa.string()), pa.list_(pa.float64())
TYPES = {"integer": INTEGERS, "text": TEXT, "words": WORDS, "vector": VECTOR}
VOCABULARY = {
    "action": ["reach", "grasp"],
    "position": ["left", "right"],
    "object": ["box"],
    "color": ["red", "blue"],
}


@pytest.fixture(autouse=True)
def _read_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes of their own take half a second; test_hostile_tables.py has them."""
    monkeypatch.setattr(
        foreign_tables,
        "load_apart",
        lambda paths: {key: table_files.load(path, COLUMNS[key]) for key, path in paths.items()},
    )


def valid() -> dict[str, dict[str, list[Any]]]:
    """Three trials with 2, 1 and 2 objects, rows out of order, as someone would write them by hand."""
    return {
        "trials": {
            "trial": [7, 2, 5],
            "attended_object": [1, 0, 0],
            "words": [["red", "grasp"], [], ["left"]],
            "action": [[0.1, 0.2, 0.3], [0.0, 1.0, 0.5], [0.4, 0.4, 0.4]],
            "truth_action": ["grasp", "reach", None],
        },
        "objects": {
            "trial": [5, 2, 7, 7, 5],
            "object": [1, 0, 1, 0, 0],
            "position": [[0.3, -0.1], [0.3, 0.1], [0.2, 0.0], [0.4, 0.0], [0.25, 0.1]],
            "object_feature": [[float(i), 1.0, 0.0, 2.0] for i in range(5)],
            "color": [[1.0, 0.0], [0.5, 0.5], [0.25, 0.75], [0.0, 1.0], [0.9, 0.1]],
            "truth_position": ["left", "right", None, "left", "left"],
            "truth_object": ["box"] * 5,
            "truth_color": ["red", "blue", "blue", "blue", "red"],
        },
    }


def arrow(data: dict[str, list[Any]], file: str) -> Any:
    kinds = {column.name: TYPES[column.kind] for column in COLUMNS[file]}
    return pa.table({name: pa.array(values, kinds[name]) for name, values in data.items()})


def save(folder: Path, tables: dict[str, Any]) -> tuple[Path, Path]:
    paths = {file: folder / f"{file}.parquet" for file in ("trials", "objects")}
    for file, path in paths.items():
        pq.write_table(tables[file], path)
    return paths["trials"], paths["objects"]


def saved(folder: Path, data: dict[str, dict[str, list[Any]]]) -> tuple[Path, Path]:
    return save(folder, {file: arrow(columns, file) for file, columns in data.items()})


def test_reads_any_row_order_sorted_by_trial_and_object(tmp_path: Path) -> None:
    table = read_table(*saved(tmp_path, valid()), need_attention=True)
    assert table.trial.tolist() == [2, 5, 7]
    assert table.attended_object.tolist() == [0, 0, 1]
    assert table.words == ((), ("left",), ("red", "grasp"))
    assert table.trial_index.tolist() == [0, 1, 1, 2, 2]
    assert table.object_feature[:, 0].tolist() == [1.0, 4.0, 0.0, 3.0, 2.0]
    assert table.truth_action == ("reach", None, "grasp")
    assert table.truth_position == ("right", "left", "left", "left", None)
    assert table.attended_row.tolist() == [0, 1, 4]
    assert table.action.dtype == table.color.dtype == np.float64


def test_unknown_attention_is_minus_one(tmp_path: Path) -> None:
    data = valid()
    data["trials"]["attended_object"] = [None, 0, None]
    table = read_table(*saved(tmp_path, data), need_attention=False)
    assert table.attended_object.tolist() == [0, -1, -1]
    assert table.attended_row.tolist() == [0, -1, -1]


@pytest.mark.parametrize("column", ["truth_action", "truth_position", "truth_object", "truth_color"])
@pytest.mark.parametrize("absent", [True, False], ids=["absent", "all null"])
def test_truth_may_be_unknown(tmp_path: Path, column: str, absent: bool) -> None:
    data = valid()
    file = "trials" if column == "truth_action" else "objects"
    if absent:
        del data[file][column]
    else:
        data[file][column] = [None] * len(data[file][column])
    assert getattr(read_table(*saved(tmp_path, data), need_attention=True), column) is None


ENCODINGS: dict[str, tuple[str, str, Any]] = {
    "narrow integers": ("trials", "trial", pa.int16()),
    "unsigned integers": ("objects", "object", pa.uint64()),
    "large text": ("objects", "truth_object", pa.large_string()),
    "dictionary text": ("objects", "truth_object", pa.dictionary(pa.int8(), pa.string())),
    "view text": ("objects", "truth_object", pa.string_view()),
    "large list": ("trials", "action", pa.large_list(pa.float64())),
    "fixed size list": ("objects", "position", pa.list_(pa.float64(), 2)),
    "single precision": ("objects", "color", pa.list_(pa.float32())),
    "large list of large text": ("trials", "words", pa.large_list(pa.large_string())),
}


@pytest.mark.parametrize("name", ENCODINGS)
def test_equivalent_encodings_read_alike(tmp_path: Path, name: str) -> None:
    file, column, type_ = ENCODINGS[name]
    tables = {key: arrow(columns, key) for key, columns in valid().items()}
    expected = read_table(*save(tmp_path, tables), need_attention=True)
    index = tables[file].column_names.index(column)
    tables[file] = tables[file].set_column(index, column, pa.array(valid()[file][column], type_))
    table = read_table(*save(tmp_path, tables), need_attention=True)
    for field, value in vars(expected).items():
        if isinstance(value, np.ndarray):
            np.testing.assert_allclose(getattr(table, field), value, atol=1e-7)
        else:
            assert getattr(table, field) == value


def test_sentences_that_are_all_empty_need_no_type(tmp_path: Path) -> None:
    tables = {file: arrow(columns, file) for file, columns in valid().items()}
    tables["trials"] = tables["trials"].set_column(2, "words", pa.array([[], [], []], pa.list_(pa.null())))
    assert read_table(*save(tmp_path, tables), need_attention=True).words == ((), (), ())


def columns_where(test: Callable[[table_columns.Column], bool]) -> list[tuple[str, str]]:
    return [(file, column.name) for file, columns in COLUMNS.items() for column in columns if test(column)]


WRONG_TYPES = {
    "integer": {"text": pa.array(["1", "2"]), "list": pa.array([[1], [2]])},
    "text": {"integer": pa.array([1, 2]), "boolean": pa.array([True]), "list": pa.array([["a"], ["b"]])},
    "words": {"text": pa.array(["red"]), "integers": pa.array([[1]]), "nested": pa.array([[["red"]]])},
    "vector": {"number": pa.array([0.5]), "texts": pa.array([["0.5"]]),
               "nested": pa.array([[[0.5]]]), "bytes": pa.array([b"abc"])},
}  # fmt: skip
type_cases = [
    pytest.param(file, column.name, values, id=f"{file}.{column.name}-{name}")
    for file, columns in COLUMNS.items()
    for column in columns
    for name, values in WRONG_TYPES[column.kind].items()
]


@pytest.mark.bad_input
@pytest.mark.parametrize(("file", "column", "values"), type_cases)
def test_wrong_type(tmp_path: Path, file: str, column: str, values: Any) -> None:
    tables = {key: arrow(columns, key) for key, columns in valid().items()}
    index, rows = tables[file].column_names.index(column), tables[file].num_rows
    tables[file] = tables[file].set_column(index, column, pa.array((values.to_pylist() * 5)[:rows], values.type))
    expect_only(tmp_path, tables, f"{file}.parquet: column '{column}' has type ", "; expected ")


@pytest.mark.bad_input
@pytest.mark.parametrize(("file", "column"), columns_where(lambda column: column.required))
def test_missing_column(tmp_path: Path, file: str, column: str) -> None:
    tables = {key: arrow(columns, key) for key, columns in valid().items()}
    tables[file] = tables[file].drop_columns([column])
    expect_only(tmp_path, tables, f"{file}.parquet: column '{column}' is missing; expected ")


@pytest.mark.bad_input
@pytest.mark.parametrize(("file", "column"), columns_where(lambda column: True))
def test_repeated_column(tmp_path: Path, file: str, column: str) -> None:
    tables = {key: arrow(columns, key) for key, columns in valid().items()}
    tables[file] = tables[file].append_column(column, tables[file].column(column))
    expect_only(tmp_path, tables, f"{file}.parquet: column '{column}' occurs 2 times; expected once")


def expect_only(folder: Path, tables: dict[str, Any], *parts: str) -> None:
    """One problem and no other, with these parts in its text; and reading raises it."""
    paths = save(folder, tables)
    problems = check_table(*paths, need_attention=True, words=VOCABULARY)
    assert len(problems) == 1, problems
    assert all(part in problems[0] for part in parts), problems[0]
    with pytest.raises(TableError) as error:
        read_table(*paths, need_attention=True)
    assert problems[0] in str(error.value)


NAN, INF = float("nan"), float("inf")
# (file, column, row, bad value, what the message says)
BAD_VALUES: list[tuple[str, str, int, Any, str]] = [
    *[(file, name, 1, None, "is null; expected")
      for file, name in columns_where(lambda column: not column.nullable and column.name != "trial")],
    ("trials", "trial", 1, None, "is null; expected int64"),
    ("objects", "trial", 0, None, "is null; expected int64"),
    ("trials", "trial", 1, 7, "repeats an earlier trial"),
    ("trials", "trial", 1, 3, "trial 3 has no object in"),
    ("objects", "trial", 0, 99, "trial 99 is not in"),
    ("objects", "object", 4, 1, "repeats object 1 of trial 5"),
    ("objects", "object", 0, 2, "is 2, but trial 5 has 2 objects; expected 0 to 1"),
    ("objects", "object", 0, -1, "is -1, but trial 5 has 2 objects; expected 0 to 1"),
    ("trials", "attended_object", 0, 2, "is 2, but trial 7 has 2 objects; expected 0 to 1"),
    ("trials", "attended_object", 1, 1, "is 1, but trial 2 has 1 objects; expected 0 to 0"),
    ("trials", "attended_object", 0, -1, "is -1; expected 0 or more, or null"),
    ("trials", "attended_object", 2, None, "is null; expected the attended object"),
    ("trials", "words", 0, ["red", ""], "is no word; expected"),
    ("trials", "words", 0, [" red"], "is no word; expected"),
    ("trials", "words", 0, ["red", None], "a word that is null"),
    *[(file, name, row, "", "is no word; expected")
      for file, name in columns_where(lambda column: column.kind == "text") for row in (0, 1)],
    *[(file, name, 0, value, message)
      for file, name in columns_where(lambda column: column.kind == "vector")
      for value, message in [
          ([], "has 0 numbers; expected"),
          ([0.5, 0.5, 0.0, 0.0, 0.0], "has 5 numbers; expected"),
          ([1.0], "has 1 numbers; expected"),
          ("nan", "nan or infinity"), ("inf", "nan or infinity"), ("-inf", "nan or infinity"),
          ("null", "holds a null"),
      ]],
    ("objects", "color", 0, [-0.5, 1.5], "negative"),
    ("objects", "color", 0, [0.5, 0.6], "sums to 1.1; expected 1"),
    ("objects", "color", 0, [0.5, 0.5 + 3e-6], "sums to 1.000003; expected 1"),
    ("objects", "color", 0, [0.0, 0.0], "sums to 0; expected 1"),
]  # fmt: skip


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("file", "column", "row", "value", "message"),
    [pytest.param(*case, id=f"{case[0]}.{case[1]}[{case[2]}]={case[3]}") for case in BAD_VALUES],
)
def test_bad_value_names_file_column_row(
    tmp_path: Path, file: str, column: str, row: int, value: Any, message: str
) -> None:
    data = valid()
    if isinstance(value, str) and column in ("action", "position", "object_feature", "color"):
        special = None if value == "null" else float(value)
        value = [special, *data[file][column][row][1:]]
    data[file][column][row] = value
    paths = saved(tmp_path, data)
    problems = check_table(*paths, need_attention=True)
    found = [problem for problem in problems if message in problem]
    assert len(found) == 1, problems
    assert f"{file}.parquet: column '{column}', row {row}: " in found[0]
    with pytest.raises(TableError, match="rows counted from 0"):
        read_table(*paths, need_attention=True)


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("file", "column", "value"),
    [
        ("trials", "words", ["purple"]),
        ("trials", "truth_action", "red"),
        ("objects", "truth_position", "box"),
        ("objects", "truth_object", "red"),
        ("objects", "truth_color", "purple"),
    ],
)
def test_words_outside_the_vocabulary(tmp_path: Path, file: str, column: str, value: Any) -> None:
    data = valid()
    data[file][column][1] = value
    paths = saved(tmp_path, data)
    assert check_table(*paths, need_attention=True) == []
    (problem,) = check_table(*paths, need_attention=True, words=VOCABULARY)
    assert f"{file}.parquet: column '{column}', row 1: " in problem
    assert "not among the experiment's words: " in problem


def test_all_problems_at_once(tmp_path: Path) -> None:
    data = valid()
    data["trials"]["attended_object"][0] = 9
    data["trials"]["action"][1] = [0.0]
    data["objects"]["color"][4] = [1.0, 1.0]
    del data["objects"]["position"]
    problems = check_table(*saved(tmp_path, data), need_attention=True)
    named = ["column 'position' is missing", "'action', row 1", "'attended_object', row 0", "'color', row 4"]
    assert len(problems) == len(named)
    for name in named:
        assert any(name in problem for problem in problems), name


def test_many_rows_with_one_problem_are_counted(tmp_path: Path) -> None:
    data = valid()
    data["objects"] = {name: values * 10 for name, values in data["objects"].items()}
    data["objects"]["object"] = [-1] * 50
    data["objects"]["trial"] = list(range(100, 150))
    problems = check_table(*saved(tmp_path, data), need_attention=True)
    assert sum("is not in" in problem for problem in problems) == MAX_ROWS_NAMED
    assert any("column 'trial': the same in 30 more rows" in problem for problem in problems)


@pytest.mark.bad_input
@pytest.mark.parametrize("file", COLUMNS)
def test_no_rows(tmp_path: Path, file: str) -> None:
    data = valid()
    data[file] = {name: [] for name in data[file]}
    problems = check_table(*saved(tmp_path, data), need_attention=True)
    assert any(f"{file}.parquet: has no rows" in problem for problem in problems), problems


def damaged(path: Path, how: str) -> None:
    content = path.read_bytes()
    if how == "missing":
        path.unlink()
    elif how == "folder":
        path.unlink()
        path.mkdir()
    elif how == "flipped":
        middle = content.index(b"grasp") if b"grasp" in content else 40
        path.write_bytes(content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :])
    else:
        path.write_bytes({"empty": b"", "text": b"trial,words\n1,red\n", "truncated": content[:-30],
                          "half": content[: len(content) // 2]}[how])  # fmt: skip


@pytest.mark.bad_input
@pytest.mark.parametrize("file", COLUMNS)
@pytest.mark.parametrize(
    ("how", "message"),
    [("missing", "no such file"), ("folder", "a folder without Parquet files"), ("empty", "not a Parquet file"),
     ("text", "not a Parquet file"), ("truncated", "truncated or damaged"), ("half", "truncated or damaged"),
     ("flipped", "truncated or damaged")],
)  # fmt: skip
def test_unreadable_file(tmp_path: Path, file: str, how: str, message: str) -> None:
    paths = tmp_path / "trials.parquet", tmp_path / "objects.parquet"
    write_table(read_table(*saved(tmp_path, valid()), need_attention=True), *paths)
    damaged(tmp_path / f"{file}.parquet", how)
    problems = check_table(*paths, need_attention=True)
    assert len(problems) == 1, problems
    assert f"{file}.parquet" in problems[0]
    assert message in problems[0]


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("limit", "unit"),
    [("MAX_TABLE_BYTES", " are read"), ("MAX_TABLE_VALUES", " numbers"), ("MAX_TABLE_ROWS", " rows")],
)
def test_too_big(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, unit: str) -> None:
    paths = saved(tmp_path, valid())
    for module in (table_files, table_parts):
        monkeypatch.setattr(module, limit, 2, raising=False)
    problems = check_table(*paths, need_attention=True)
    assert len(problems) == 2
    assert all("at most " in problem and f" 2{unit}" in problem for problem in problems)


@pytest.mark.bad_input
def test_a_small_file_that_unpacks_to_too_much_is_not_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tables = {file: arrow(columns, file) for file, columns in valid().items()}
    tables["trials"] = pa.concat_tables([tables["trials"]] * 5000)
    paths = save(tmp_path, tables)
    monkeypatch.setattr(table_files, "MAX_TABLE_ROWS", 10_000)
    monkeypatch.setattr(pq.ParquetFile, "read_row_group", None)
    read = table_files.load(paths[0], COLUMNS["trials"])
    assert read.table is None
    assert "holds 15,000 rows" in read.problems[0]


@pytest.fixture
def table(tmp_path: Path) -> FeatureTable:
    return read_table(*saved(tmp_path, valid()), need_attention=True)


def test_written_tables_read_back_and_repeat_byte_by_byte(table: FeatureTable, tmp_path: Path) -> None:
    digests = []
    for name, metadata in (("one", {"b": "2", "a": "1"}), ("two", {"a": "1", "b": "2"})):
        paths = tmp_path / name / "trials.parquet", tmp_path / name / "objects.parquet"
        write_table(table, *paths, metadata)
        again = read_table(*paths, need_attention=True)
        for field, value in vars(table).items():
            same = np.array_equal if isinstance(value, np.ndarray) else operator.eq
            assert same(getattr(again, field), value), field
        assert read_metadata(paths[0]) == read_metadata(paths[1]) == {"a": "1", "b": "2"}
        assert sorted(path.name for path in (tmp_path / name).iterdir()) == [
            "objects.parquet",
            "trials.parquet",
        ]
        digests.append([hashlib.sha256(path.read_bytes()).hexdigest() for path in paths])
    assert digests[0] == digests[1]


def test_a_table_that_breaks_the_contract_is_not_written(table: FeatureTable, tmp_path: Path) -> None:
    paths = tmp_path / "new" / "trials.parquet", tmp_path / "new" / "objects.parquet"
    with pytest.raises(TableError, match="column 'color', row 0: sums to 2"):
        write_table(replace(table, color=2 * table.color), *paths)
    assert not paths[0].parent.exists()


def test_head_takes_the_first_trials_and_their_objects(table: FeatureTable) -> None:
    first = head(table, 2)
    assert first.trial.tolist() == [2, 5]
    assert first.words == ((), ("left",))
    np.testing.assert_array_equal(first.position, table.position[:3])
    assert first.truth_color == ("blue", "red", "red")
    for D in (0, 4):
        with pytest.raises(ValueError, match=f"D is {D}; expected 1 to 3"):
            head(table, D)


@pytest.mark.parametrize("file", COLUMNS)
def test_the_page_shows_the_columns_of_the_code(file: str) -> None:
    page = Path(__file__).parents[2] / "docs/features.md"
    assert table_columns.markdown(file) in page.read_text(encoding="utf-8")
