"""Records in `OUT/.artifacts`: the content of each artifact, and what made it.

A record is written when its artifact is complete; whoever reads the artifact compares the checksum.
"""

from __future__ import annotations

import errno
import hashlib
import json
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from data_collection.files import write_text
from workflow.artifacts.copies import remove_any
from workflow.artifacts.keys import hash_of, job_key, output_key, plain

FOLDER = ".artifacts"
FULL = (errno.ENOSPC, errno.EDQUOT)  # the disk, or the user's quota, is full
PATIENCE = 10.0  # seconds to wait for an input's record, which another machine may have written


class DamagedError(ValueError):
    """An artifact does not match its record."""


@dataclass(frozen=True)
class Content:
    """The content of a file or folder.

    Attributes:
        sha256: Of the file, or of a folder's `files`.
        size: In bytes.
        files: sha256 by path of the files in a folder; None for a file.
    """

    sha256: str
    size: int
    files: Mapping[str, str] | None = None


@dataclass(frozen=True)
class Input:
    """An input of a job. `path` is relative to OUT for an artifact, and the bare name of an external file."""

    path: str
    sha256: str
    key: str
    artifact: bool


@dataclass(frozen=True)
class Record:
    """The record of an artifact: its content and what made it. Parameters are plain JSON data."""

    sha256: str
    size: int
    key: str
    rule: str
    wildcards: Mapping[str, str]
    parameters: Mapping[str, Any]
    role: str
    inputs: Mapping[str, Input] = field(default_factory=dict)
    files: Mapping[str, str] | None = None

    @staticmethod
    def from_mapping(data: Mapping[str, Any]) -> Record:
        """The record of plain data, as `asdict` makes them of one.

        Raises:
            ValueError, TypeError, KeyError: The data are not a record.
        """
        inputs = {role: Input(**each) for role, each in data["inputs"].items()}
        return Record(**{**data, "inputs": inputs})

    def explains_its_key(self) -> bool:
        """Whether the key follows from the rule, wildcards, parameters and inputs."""
        keys = {role: each.key for role, each in self.inputs.items()}
        return self.key == output_key(job_key(self.rule, self.wildcards, self.parameters, keys), self.role)


def content(path: Path) -> Content:
    """The content of a file or folder.

    Raises:
        OSError: It cannot be read.
    """
    if not path.is_dir():
        with path.open("rb") as file:
            sha256 = hashlib.file_digest(file, "sha256").hexdigest()
            return Content(sha256, file.tell())
    inside = sorted(each for each in path.rglob("*") if each.is_file() and not each.name.startswith("."))
    files = {each.relative_to(path).as_posix(): content(each) for each in inside}
    hashes = {name: each.sha256 for name, each in files.items()}
    return Content(hash_of(hashes), sum(each.size for each in files.values()), hashes)


def contents(out: Path, paths: Sequence[str]) -> dict[str, Content | None]:
    """The content of each artifact by path; None if it cannot be read."""

    def of(path: str) -> Content | None:
        try:
            return content(out / path)
        except OSError:
            return None

    with ThreadPoolExecutor() as pool:  # hashing releases the GIL
        return dict(zip(paths, pool.map(of, paths), strict=True))


def record_path(out: Path, path: str) -> Path:
    """The path of an artifact's record."""
    return out / FOLDER / f"{path}.json"


def read_record(out: Path, path: str) -> Record | None:
    """The record of an artifact; None if there is no readable one."""
    try:
        return Record.from_mapping(json.loads(record_path(out, path).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError):
        return None


def await_record(out: Path, path: str, patience: float) -> Record | None:
    """Read a record, waiting some seconds for one that a shared file system may show late."""
    until = time.monotonic() + patience
    while (record := read_record(out, path)) is None and time.monotonic() < until:
        time.sleep(0.5)
    return record


def write_record(out: Path, path: str, record: Record) -> None:
    """Write the record of an artifact."""
    write_text(record_path(out, path), json.dumps(asdict(record), sort_keys=True, indent=1) + "\n")


def remove(out: Path, path: str) -> None:
    """Remove an artifact and its record, if they exist."""
    record_path(out, path).unlink(missing_ok=True)
    remove_any(out / path, ignore_errors=False)


def verified_inputs(out: Path, paths: Mapping[str, str]) -> dict[str, Input]:
    """Compare the inputs of a job, by role, with their records. Absolute paths are external files.

    Raises:
        DamagedError: An artifact does not match its record. It was removed, so that the next run makes it again.
    """
    verified = cache(lambda path: _verified(out, path))
    return {role: verified(path) for role, path in paths.items()}


def _verified(out: Path, path: str) -> Input:
    found = content(out / path)
    if Path(path).is_absolute():
        return Input(Path(path).name, found.sha256, found.sha256, artifact=False)
    record = await_record(out, path, PATIENCE)
    if record is None:
        raise DamagedError(f"{path} has no record; `python -m workflow run` makes it again")
    if record.sha256 != found.sha256:
        remove(out, path)
        raise DamagedError(
            f"{path} is damaged: sha256 {found.sha256[:12]}…, but {record.sha256[:12]}… when it was made; "
            "it was removed, run again and it will be made"
        )
    return Input(path, record.sha256, record.key, artifact=True)


def records_of_job(
    out: Path,
    rule: str,
    wildcards: Mapping[str, str],
    parameters: Mapping[str, Any],
    inputs: Mapping[str, Input],
    outputs: Mapping[str, str],
) -> dict[str, Record]:
    """The records, by path, of what a job has made."""
    key = job_key(rule, wildcards, parameters, {role: each.key for role, each in inputs.items()})
    records = {}
    for role, path in outputs.items():
        found = content(out / path)
        records[path] = Record(
            sha256=found.sha256,
            size=found.size,
            key=output_key(key, role),
            rule=rule,
            wildcards=dict(wildcards),
            parameters=plain(parameters),
            role=role,
            inputs=dict(inputs),
            files=found.files,
        )
    return records
