"""What a path stands for before it is read: files, parts of a table in a folder, and what their names tell."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa

from features.size_limits import MAX_TABLE_BYTES
from features.table_columns import Column

DAMAGED = "not a Parquet file, truncated or damaged"
PART_SUFFIXES = (".parquet", ".pq", ".parq")
OTHER_FILES = {
    b"ARROW1": "an Arrow or Feather file",
    b"FEA1": "a Feather file",
    b"PK\x03\x04": "a zip, npz or Excel file",
    b"\x1f\x8b": "a gzip file",
    b"SQLite format 3": "an SQLite file",
    b"\x89HDF": "an HDF5 file",
    b"\x93NUMPY": "an npy file",
    b"ORC": "an ORC file",
    b"Obj\x01": "an Avro file",
    b"version https://git-lfs": "a pointer of Git LFS, whose file was not fetched",
}


def parts_of(path: Path) -> list[Path]:
    """The Parquet files that a path stands for: itself, or what a folder holds, by name, hidden files left out."""
    if not path.is_dir():
        return [path]
    return [
        part
        for part in sorted(path.rglob("*"))
        if part.suffix in PART_SUFFIXES
        and part.is_file()
        and not any(name.startswith(("_", ".")) for name in part.relative_to(path).parts)
    ]


def place_of(files: Path | Sequence[Path]) -> Path:
    """The path that stands for parts: the inverse of `parts_of`, but for folders that hold nothing else."""
    return files if isinstance(files, Path) else Path(os.path.commonpath(files))


def no_file(path: Path) -> list[str]:
    """Why a path cannot be read as a file; nothing if it can be tried."""
    if not path.is_file():
        return [f"{path}: no such file" if not path.exists() else f"{path}: not a file"]
    if path.stat().st_size > MAX_TABLE_BYTES:
        return [f"{path}: {path.stat().st_size:,} bytes; at most {MAX_TABLE_BYTES:,} are read"]
    return []


def no_parquet(path: Path) -> str:
    """What a file is that cannot be read as Parquet."""
    with path.open("rb") as file:
        head = file.read(4096)
    told = next((told for magic, told in OTHER_FILES.items() if head.startswith(magic)), "")
    if not told and head.count(b",") > 2 and head.isascii() and head.decode("ascii").split("\n")[0].isprintable():
        told = "text, perhaps CSV"
    return f"{DAMAGED} (it begins like {told}; write it with DataFrame.to_parquet)" if told else DAMAGED


def restored(path: Path, schema: Any, columns: Sequence[Column], rows: int) -> dict[str, Any]:
    """Columns of the contract that a file tells of without storing them.

    pandas keeps an index that only counts as its first and last number; Spark and others write a column on which a
    table is split into the names of folders, `trial=3`.
    """
    missing = {column.name: column for column in columns if column.name not in schema.names}
    found = {}
    for part in path.parent.parts:
        name, sign, value = part.partition("=")
        if sign and name in missing and missing[name].kind == "integer" and re.fullmatch(r"\d{1,18}", value):
            found[name] = pa.array([int(value)] * rows, pa.int64())
        elif sign and name in missing and missing[name].kind == "text":
            found[name] = pa.array([None if value == "__HIVE_DEFAULT_PARTITION__" else value] * rows, pa.string())
    try:
        indices = json.loads((schema.metadata or {}).get(b"pandas", b"{}"))["index_columns"]
        for index in indices:
            if isinstance(index, dict) and index["kind"] == "range" and index["name"] in missing:
                numbers = range(index["start"], index["stop"], index["step"])
                if len(numbers) == rows and missing[index["name"]].kind == "integer":
                    found[index["name"]] = pa.array(numbers, pa.int64())
    except (KeyError, TypeError, ValueError, RecursionError, OverflowError, pa.ArrowException):
        pass  # metadata of somebody else
    return found
