"""Parquet files of strangers: every column in every wrong type and value, absurd sizes, pickles, random bytes."""

from __future__ import annotations

import base64
import faulthandler
import functools
import json
import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

from features import foreign_tables, table_files
from features.size_limits import MAX_TABLE_BYTES, MAX_VECTOR_LENGTH
from features.table import FeatureTable, TableError, check_table, read_table, write_table
from features.table_columns import FILES as COLUMNS
from features.table_columns import Column
from features.table_parts import DAMAGED as DAMAGED_FILE
from tests.bounded import errors_within
from tests.features.test_table import arrow, save, saved, valid
from tests.fuzz import FEW, MANY, MUTATIONS, Mutation, examples, mutated

NAN, INF = float("nan"), float("inf")
EVERY = [(file, column) for file, columns in COLUMNS.items() for column in columns]
TYPES = {
    "boolean": pa.bool_(),
    "integer": pa.int64(),
    "double": pa.float64(),
    "half": pa.float16(),
    "decimal": pa.decimal128(9, 2),
    "text": pa.string(),
    "bytes": pa.binary(),
    "fixed bytes": pa.binary(4),
    "time": pa.timestamp("ns"),
    "date": pa.date32(),
    "duration": pa.duration("s"),
    "struct": pa.struct([("x", pa.int64()), ("y", pa.list_(pa.string()))]),
    "map": pa.map_(pa.string(), pa.int64()),
    "list of booleans": pa.list_(pa.bool_()),
    "list of integers": pa.list_(pa.int64()),
    "list of doubles": pa.list_(pa.float64()),
    "list of texts": pa.list_(pa.string()),
    "list of bytes": pa.list_(pa.binary()),
    "list of structs": pa.list_(pa.struct([("x", pa.float64())])),
    "list of lists": pa.list_(pa.list_(pa.float64())),
    "list of lists of texts": pa.list_(pa.list_(pa.string())),
    "dictionary of integers": pa.dictionary(pa.int8(), pa.int64()),
}
FITTING = {
    "integer": {"integer", "dictionary of integers", "double", "half", "decimal"},
    "text": {"text", "bytes", "double", "half"},  # numbers only where all are missing
    "words": {"list of texts", "list of bytes"},
    "vector": {"list of doubles", "list of integers", "list of booleans"},
}
WRONG = [
    pytest.param(file, column, TYPES[name], id=f"{file}.{column.name}-{name}")
    for file, column in EVERY
    for name in TYPES
    if name not in FITTING[column.kind]
]


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("hostile_tables")


def tables() -> dict[str, Any]:
    return {key: arrow(columns, key) for key, columns in valid().items()}


def refusals(paths: tuple[Path, Path]) -> tuple[str, ...]:
    """The problems that the reader raises."""
    with pytest.raises(TableError) as caught:
        read_table(*paths, need_attention=True)
    return caught.value.problems


@pytest.mark.bad_input
@pytest.mark.parametrize(("file", "column", "kind"), WRONG)
def test_a_column_of_any_other_type_is_refused(folder: Path, file: str, column: Column, kind: Any) -> None:
    made = tables()
    index, rows = made[file].column_names.index(column.name), made[file].num_rows
    if pa.types.is_map(kind) or pa.types.is_dictionary(kind):
        values = pa.nulls(rows, kind)
    else:
        values = pa.array([None] * rows, kind)
    made[file] = made[file].set_column(index, column.name, values)
    problems = refusals(save(folder, made))
    assert any(f"{file}.parquet: column {column.name!r} has type " in problem for problem in problems), problems


BAD_WORDS = (
    "",
    " ",
    "two words",
    "a\n",
    "a\0",
    "\x1b[31m",
    "a\u200b",
    "\u202eb",
    "=1+1",
    "+1",
    "-1",
    "@x",
    "NA",
    "7",
    "x" * 41,
)


def bad_values() -> Iterator[Any]:
    for file, column in EVERY:
        row = 1
        value: Any = valid()[file][column.name][row]
        if column.kind == "integer":
            wrong: list[Any] = [-(2**63), 2**63 - 1, -1]
        elif column.kind == "text":
            wrong = list(BAD_WORDS)
        elif column.kind == "words":
            wrong = [["red", word] for word in BAD_WORDS] + [[None], ["red"] * 5 + [None]]
        else:
            wrong = [value[:-1], [*value, 0.0], [], [0.0] * (MAX_VECTOR_LENGTH + 1)]
            for i in range(len(value)):
                wrong += [[*value[:i], bad, *value[i + 1 :]] for bad in (NAN, INF, -INF, 1e300, -1e10, None)]
        for one in wrong:
            if (column.name, one) != ("trial", -1):
                yield pytest.param(file, column, row, one, id=f"{file}.{column.name}-{one!r:.40}")


@pytest.mark.bad_input
@pytest.mark.parametrize(("file", "column", "row", "value"), list(bad_values()))
def test_a_bad_value_is_refused(folder: Path, file: str, column: Column, row: int, value: Any) -> None:
    data = valid()
    data[file][column.name][row] = value
    problems = refusals(saved(folder, data))
    name = column.name
    assert any(f"{file}.parquet: column {name!r}, row {row}: " in p or f"row {row}" in p for p in problems), problems


@pytest.mark.bad_input
@pytest.mark.parametrize(
    ("file", "column"),
    [(file, column) for file, column in EVERY if column.kind == "vector" and column.length is None],
)
def test_vectors_of_absurd_length_are_refused(folder: Path, file: str, column: Column) -> None:
    data = valid()
    long = [1.0] + [0.0] * MAX_VECTOR_LENGTH
    data[file][column.name] = [long for _ in data[file][column.name]]
    (problem,) = refusals(saved(folder, data))
    assert f"column {column.name!r}: 1,001 numbers per row; at most 1,000" in problem


@pytest.mark.parametrize(
    ("column", "kind"),
    [
        ("words", pa.list_(pa.dictionary(pa.int32(), pa.string()))),
        ("words", pa.large_list(pa.large_string())),
        ("truth_action", pa.dictionary(pa.int8(), pa.large_string())),
    ],
    ids=str,
)
def test_texts_in_any_encoding_read_alike(folder: Path, column: str, kind: Any) -> None:
    made = tables()
    expected = read_table(*save(folder, made), need_attention=True)
    index = made["trials"].column_names.index(column)
    values = pa.array(valid()["trials"][column], kind) if "words" == column else made["trials"][column].cast(kind)
    made["trials"] = made["trials"].set_column(index, column, values)
    table = read_table(*save(folder, made), need_attention=True)
    assert (table.words, table.truth_action) == (expected.words, expected.truth_action)


class Evil:
    """Unpickled, it makes a file."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.path),)


def test_pickles_in_metadata_are_never_unpickled(folder: Path) -> None:
    made, sign = tables(), folder / "unpickled"
    evil = pickle.dumps(Evil(sign))
    pandas = {b"pandas": evil, b"ARROW:schema": base64.b64encode(evil)}
    extension = {b"ARROW:extension:name": b"arrow.py_extension_type", b"ARROW:extension:metadata": evil}
    fields = [field.with_metadata(extension) for field in made["trials"].schema]
    made["trials"] = made["trials"].cast(pa.schema(fields)).replace_schema_metadata(pandas)
    paths = save(folder, made)
    with suppress(TableError):
        read_table(*paths, need_attention=True)
    assert not sign.exists()
    pickle.loads(evil)
    assert sign.exists()


SPECIAL: dict[str, Callable[[Path], None]] = {
    "a pipe": lambda path: os.mkfifo(path),
    "a device": lambda path: path.symlink_to("/dev/zero"),
    "a folder": lambda path: path.mkdir(),
    "a link to nothing": lambda path: path.symlink_to("nowhere"),
    "a link to itself": lambda path: path.symlink_to(path),
}


@pytest.mark.bad_input
@pytest.mark.parametrize("name", SPECIAL)
def test_what_is_no_file_is_refused(tmp_path: Path, name: str) -> None:
    paths = saved(tmp_path, valid())
    paths[0].unlink()
    SPECIAL[name](paths[0])
    problem = refusals(paths)[0]
    assert any(says in problem for says in ("not a file", "no such file", "a folder without Parquet files")), problem


def test_a_link_to_a_file_is_read(tmp_path: Path) -> None:
    trials, objects = saved(tmp_path, valid())
    link = tmp_path / "link"
    link.symlink_to(trials)
    assert check_table(link, objects, need_attention=True) == []


def flat(name: str, values: Any, rows: int) -> Any:
    """A table of trials in which one column is `values` and all others are short and repeat."""
    one = {key: column[0] for key, column in valid()["trials"].items()}
    arrays = {
        key: pa.repeat(pa.scalar(value, arrow(valid()["trials"], "trials")[key].type), rows)
        for key, value in one.items()
    }
    return pa.table(arrays | {name: values})


LONG = "x" * 10**6
BOMBS: dict[str, tuple[Callable[[], pa.Table], str]] = {
    "a text of 1 MB in each of 20,000 rows": (
        lambda: flat("truth_action", pa.DictionaryArray.from_arrays(np.zeros(20_000, np.int32), [LONG]), 20_000),
        "column 'truth_action' has a text of more than 160 bytes",
    ),
    "words of 1 MB": (
        lambda: flat(
            "words",
            pa.ListArray.from_arrays(
                np.arange(5001, dtype=np.int32), pa.DictionaryArray.from_arrays(np.zeros(5000, np.int32), [LONG])
            ),
            5000,
        ),
        "column 'words' has a text of more than 160 bytes",
    ),
    "a column that nobody knows": (
        lambda: flat("other", pa.DictionaryArray.from_arrays(np.zeros(20_000, np.int32), [LONG]), 20_000),
        "column is passed over, which no table has: 'other'",
    ),
    "three million rows": (lambda: pa.table({"trial": pa.repeat(7, 3_000_000)}), "holds 3,000,000 rows"),
    "three million words in a row": (
        lambda: flat("words", pa.ListArray.from_arrays([0, 3_000_000], pa.repeat("x", 3_000_000)), 1),
        "3,000,000 texts",
    ),
}  # fmt: skip
DAMAGED = {
    "encrypted": b"PARE" + bytes(100) + b"\x10\0\0\0PARE",
    "a footer of 4 GiB": b"PAR1" + bytes(100) + b"\xff\xff\xff\xffPAR1",
    "a footer of zeros": b"PAR1" + bytes(100) + b"\x20\0\0\0PAR1",
    "only the magic": b"PAR1PAR1",
    "a pickle": pickle.dumps({"trial": [1]}),
    "a zip": b"PK\x03\x04" + bytes(100),
}


@functools.cache
def bomb_errors(base: str) -> dict[str, str]:
    """The problem of each bad file, in a process whose readers hand nothing large over to it."""
    paths = {}
    for name, (make, _) in BOMBS.items():
        paths[name] = Path(base) / f"{name.replace(' ', '_')}.parquet"
        pq.write_table(make(), paths[name], compression="zstd", dictionary_pagesize_limit=2**22)
    for name, content in DAMAGED.items():
        paths[name] = Path(base) / f"{name.replace(' ', '_')}.parquet"
        paths[name].write_bytes(content)
    paths["a file of more than a gibibyte"] = Path(base) / "sparse.parquet"
    with paths["a file of more than a gibibyte"].open("wb") as file:
        file.truncate(MAX_TABLE_BYTES + 1)
    return errors_within(
        3 * 2**29,
        "from features.foreign_tables import load_apart",
        "read = load_apart({'trials': path})['trials']; raise ValueError([*read.problems, *read.notes][0])",
        "ValueError",
        paths,
    )


EXPECTED = {name: says for name, (_, says) in BOMBS.items()} | dict.fromkeys(DAMAGED, "not a Parquet file")
EXPECTED["a file of more than a gibibyte"] = "bytes; at most 1,073,741,824 are read"


@pytest.mark.bad_input
@pytest.mark.parametrize("name", EXPECTED)
def test_an_absurd_file_is_refused_within_bounded_memory(folder: Path, name: str) -> None:
    says = bomb_errors(str(folder))[name]
    assert EXPECTED[name] in says
    assert ".parquet: " in says


def in_a_fork(read: Callable[[], FeatureTable]) -> FeatureTable | TableError | None:
    """What a fork of this process reads or is refused; None where it was ended by a signal."""
    receiver, sender = multiprocessing.Pipe(duplex=False)
    process = os.fork()
    if process == 0:
        faulthandler.disable()  # a crash is an answer
        signal.alarm(60)
        try:
            sender.send(read())
        except TableError as error:
            sender.send(tuple(error.problems))
        finally:
            os._exit(0)
    sender.close()
    with suppress(EOFError):
        said = receiver.recv()
    if os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) != 0:
        return None
    return said if isinstance(said, FeatureTable) else TableError(said)


def reader_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, does: str) -> str:
    """The problem of sound files whose reader does something else than reading."""
    program = tmp_path / "python"
    program.write_text(f"#!/bin/sh\n{does}\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))
    return check_table(*saved(tmp_path, valid()), need_attention=True)[0]


def test_a_reader_that_crashes_is_a_problem_of_its_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = reader_that(tmp_path, monkeypatch, "kill -ABRT $$")
    assert problem == f"{tmp_path}/trials.parquet: {DAMAGED_FILE}: reading it ended with SIGABRT"


def test_a_reader_imports_nothing_from_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "json.py").write_text("raise SystemExit(3)")
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    assert check_table(*saved(tmp_path, valid()), need_attention=True) == []


def test_a_reader_that_hangs_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(foreign_tables, "MAX_READER_SECONDS", 1)
    assert "not read within 1 seconds" in reader_that(tmp_path, monkeypatch, "exec sleep 60")


@pytest.mark.parametrize(
    ("megabytes", "says"), [(2**9, "larger than a table may be: reading it takes too much memory"), (2**12, None)]
)
def test_a_reader_has_a_bounded_memory(tmp_path: Path, megabytes: int, says: str | None) -> None:
    """A sound column of 320 MB, whose footer says so, and readers with more and with less memory than it needs."""
    path = tmp_path / "trials.parquet"
    vectors = pa.FixedSizeListArray.from_arrays(pa.array(np.zeros(40_000_000)), 20)
    pq.write_table(pa.table({"trial": np.arange(len(vectors)), "action": vectors}), path)
    program = "import sys; from features import foreign_tables as f; f.MAX_READER_BYTES = int(sys.argv.pop(1)); "
    done = subprocess.run(
        [
            sys.executable,
            "-c",
            f"{program}f._read('trials', *sys.argv[1:])",
            str(megabytes * 2**20),
            path,
            tmp_path / "out",
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert (tmp_path / "out").exists() == (says is None)
    assert says is None or json.loads(done.stdout)["problems"] == [f"{path}: {says}"]


def read_damaged(folder: Path, which: int, mutations: list[Mutation]) -> None:
    """It is refused, or says what it said: its pages have checksums, and what the footer says must match them."""
    (folder / "sound").mkdir(exist_ok=True)
    paths = folder / "sound" / "trials.parquet", folder / "sound" / "objects.parquet"
    if not paths[1].exists():
        write_table(read_table(*saved(folder, valid()), need_attention=True), *paths)
    damaged = [folder / f"damaged_{path.name}" for path in paths]
    for i, path in enumerate(paths):
        content = path.read_bytes()
        damaged[i].write_bytes(mutated(content, mutations) if i == which else content)
    found = in_a_fork(lambda: read_table(*damaged, need_attention=True))
    if isinstance(found, TableError):
        assert damaged[which].name in " ".join(found.problems)
        return
    if found is None:  # Arrow ended the process, which a stranger's file may do to its reader.
        assert damaged[which].name in check_table(*damaged, need_attention=True)[0]
        return
    original = read_table(*paths, need_attention=True)
    for name, value in vars(original).items():
        np.testing.assert_array_equal(np.asarray(getattr(found, name), dtype=object), np.asarray(value, dtype=object))


@examples(FEW)
@given(which=st.integers(0, 1), mutations=MUTATIONS)
def test_fuzz_damaged_files(folder: Path, which: int, mutations: list[Mutation]) -> None:
    read_damaged(folder, which, mutations)


@pytest.mark.slow
@examples(MANY)
@given(which=st.integers(0, 1), mutations=MUTATIONS)
def test_fuzz_damaged_files_much(folder: Path, which: int, mutations: list[Mutation]) -> None:
    read_damaged(folder, which, mutations)


@examples(FEW)
@given(content=st.binary(max_size=200), footer=st.booleans())
def test_fuzz_any_bytes(folder: Path, content: bytes, footer: bool) -> None:
    trials, objects = saved(folder, valid())
    if footer:
        content = b"PAR1" + content + len(content).to_bytes(4, "little") + b"PAR1"
    trials.write_bytes(content)
    found = in_a_fork(lambda: read_table(trials, objects, need_attention=True))
    problems = found.problems if isinstance(found, TableError) else check_table(trials, objects, need_attention=True)
    assert "trials.parquet: not a Parquet file" in problems[0]


@pytest.mark.bad_input
@pytest.mark.parametrize("column", ["trial", "words", "action", "truth_action"])
def test_pages_that_hold_something_else_than_the_footer_says(
    folder: Path, monkeypatch: pytest.MonkeyPatch, column: str
) -> None:
    paths = saved(folder, valid())
    leaves = [leaf.split(".")[0] for leaf in (pq.ParquetFile(paths[0]).schema.column(i).path for i in range(5))]
    counts = table_files._values_per_leaf(pq.read_metadata(paths[0]))
    counts[leaves.index(column)] -= 1
    monkeypatch.setattr(table_files, "_values_per_leaf", lambda metadata: counts)
    read = table_files.load(paths[0], COLUMNS["trials"])
    assert read.table is None
    assert f"column {column!r} holds" in read.problems[0]


@pytest.mark.parametrize(
    "options",
    [
        {"data_page_version": "2.0"},
        {"version": "1.0"},
        {"row_group_size": 1},
        {"compression": "none", "use_dictionary": False},
        {"compression": "gzip", "write_page_index": True},
        {"compression": "brotli", "write_statistics": False},
        {"compression": "lz4", "data_page_size": 1, "store_schema": False},
    ],
    ids=str,
)
def test_files_of_any_writer_are_read(folder: Path, options: dict[str, Any]) -> None:
    expected = read_table(*saved(folder, valid()), need_attention=True)
    paths = folder / "trials.parquet", folder / "objects.parquet"
    for path, table in zip(paths, tables().values(), strict=True):
        pq.write_table(table, path, **options)
    assert read_table(*paths, need_attention=True).words == expected.words
