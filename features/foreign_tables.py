"""Read Parquet files of unknown origin in child processes with limited memory and time.

A file of a few kilobytes can unpack to terabytes, and some damage to a footer crashes Arrow and the process with it.
So a child process reads each file and returns the columns that the contract knows.
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

import pyarrow as pa

from features.size_limits import MAX_READER_BYTES, MAX_READER_SECONDS
from features.table_columns import FILES
from features.table_files import Read, load
from features.table_parts import DAMAGED


def load_apart(paths: Mapping[str, Path]) -> dict[str, Read]:
    """Read files as `table_files.load` does, each in a child process.

    Args:
        paths: The files, or folders of files, by their keys in `FILES`.

    Returns:
        What came of each, by the same keys.
    """
    root = str(Path(__file__).resolve().parents[1])
    # An empty part would be the current folder, whose modules would come before Python's own.
    places = os.pathsep.join(filter(None, [root, *os.environ.get("PYTHONPATH", "").split(os.pathsep)]))
    environment = os.environ | {"PYTHONPATH": places}
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


def _result(reader: subprocess.Popen[bytes], path: Path, out: Path) -> Read:
    """What a child found, or how it ended."""
    try:
        said, _ = reader.communicate(timeout=MAX_READER_SECONDS)
    except subprocess.TimeoutExpired:
        reader.kill()
        reader.communicate()
        return Read(None, [f"{path}: {DAMAGED}: not read within {MAX_READER_SECONDS} seconds"])
    if reader.returncode != 0:
        how = Signals(-reader.returncode).name if reader.returncode < 0 else f"status {reader.returncode}"
        return Read(None, [f"{path}: {DAMAGED}: reading it ended with {how}"])
    table = pa.ipc.open_file(pa.py_buffer(out.read_bytes())).read_all() if out.exists() else None
    return Read(table, **json.loads(said))


def _read(key: str, path: str, out: str) -> None:
    """Read a file within the memory limit; problems and notes go to stdout, the table to `out`."""
    pa.set_memory_pool(pa.system_memory_pool())  # the only pool that reserves nothing in advance
    allowed = resource.getrlimit(resource.RLIMIT_AS)[1]
    limit = MAX_READER_BYTES if allowed == resource.RLIM_INFINITY else min(allowed, MAX_READER_BYTES)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    read = load(Path(path), FILES[key])
    if read.table is not None:
        with pa.OSFile(out, "wb") as file, pa.ipc.new_file(file, read.table.schema) as writer:
            writer.write_table(read.table)
    sys.stdout.write(json.dumps({"problems": read.problems, "notes": read.notes}))


if __name__ == "__main__":
    _read(*sys.argv[1:])
