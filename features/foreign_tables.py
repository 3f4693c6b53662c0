"""Read the Parquet files of strangers in processes of their own.

A file of a few kilobytes can unpack to terabytes, and Arrow ends the whole process where some parts of a footer are
damaged. So a process with a bounded memory reads each file, and hands over the columns that the contract knows.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from signal import Signals
from typing import Any

import pyarrow as pa

from features.size_limits import MAX_READER_BYTES, MAX_READER_SECONDS
from features.table_columns import FILES
from features.table_files import DAMAGED, load


def load_apart(paths: Mapping[str, Path]) -> dict[str, tuple[Any, list[str]]]:
    """Read files as `table_files.load` does, each in a process of its own.

    Args:
        paths: The files by the key of their columns in `FILES`.

    Returns:
        By the same keys the Arrow table, None where the file cannot be read, and the problems of file and types.
    """
    root = str(Path(__file__).resolve().parents[1])
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])}
    environment |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}  # each thread reserves address space
    with tempfile.TemporaryDirectory() as folder:
        outs = {key: Path(folder) / key for key in paths}
        readers = {
            key: subprocess.Popen(
                [sys.executable, "-P", "-m", "features.foreign_tables", key, str(path), str(outs[key])],
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env=environment,
            )
            for key, path in paths.items()
        }
        return {key: _result(reader, paths[key], outs[key]) for key, reader in readers.items()}


def _result(reader: subprocess.Popen[bytes], path: Path, out: Path) -> tuple[Any, list[str]]:
    """What a reader found, or how it ended."""
    try:
        said, _ = reader.communicate(timeout=MAX_READER_SECONDS)
    except subprocess.TimeoutExpired:
        reader.kill()
        reader.communicate()
        return None, [f"{path}: {DAMAGED}: not read within {MAX_READER_SECONDS} seconds"]
    if reader.returncode != 0:
        how = Signals(-reader.returncode).name if reader.returncode < 0 else f"status {reader.returncode}"
        return None, [f"{path}: {DAMAGED}: reading it ended with {how}"]
    table = pa.ipc.open_file(pa.py_buffer(out.read_bytes())).read_all() if out.exists() else None
    return table, json.loads(said)


def _read(key: str, path: str, out: str) -> None:
    """Read a file within the memory that a reader may take; problems go to stdout, the table to `out`."""
    pa.set_memory_pool(pa.system_memory_pool())  # of all pools the one that reserves nothing in advance
    allowed = resource.getrlimit(resource.RLIMIT_AS)[1]
    limit = MAX_READER_BYTES if allowed == resource.RLIM_INFINITY else min(allowed, MAX_READER_BYTES)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    table, problems = load(Path(path), FILES[key])
    if table is not None:
        with pa.OSFile(out, "wb") as file, pa.ipc.new_file(file, table.schema) as writer:
            writer.write_table(table)
    sys.stdout.write(json.dumps(problems))


if __name__ == "__main__":
    _read(*sys.argv[1:])
