"""The lineage of an artifact as a tree, back to seeds, settings and external files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from workflow.artifacts.provenance import parts_of_code
from workflow.artifacts.records import FOLDER, Input, Record, read_record

WIDTH = 100


def output_folder(path: Path) -> Path:
    """The output folder that contains an artifact.

    Raises:
        ValueError: There is none.
    """
    for folder in path.absolute().parents:
        if (folder / FOLDER).is_dir():
            return folder
    raise ValueError(f"{path}: not in the output folder of a study (none of its folders has {FOLDER})")


def explain(out: Path, path: str) -> Iterator[str]:
    """The lines of an artifact's tree.

    Args:
        out: The output folder.
        path: The artifact's path in it.

    Raises:
        ValueError: The artifact has no record.
    """
    record = read_record(out, path)
    if record is None:
        raise ValueError(f"{path} has no record")
    yield f"{path}  {_hashes(record.sha256, record.key)}"
    yield from _maker(out, record, "", set())


def _maker(out: Path, record: Record, margin: str, seen: set[str]) -> Iterator[str]:
    """The job that made an artifact: rule, wildcards, parameters, inputs. Each job is described once."""
    job = json.dumps([record.rule, dict(record.wildcards), record.parameters], sort_keys=True)
    made_by = " ".join([f"rule {record.rule}", *(f"{name}={value}" for name, value in record.wildcards.items())])
    if job in seen:
        yield f"{margin}   made by {made_by} (as above)"
        return
    seen.add(job)
    yield f"{margin}   made by {made_by}"
    for name, value in sorted(record.parameters.items()):
        yield f"{margin}   {name}: {_code(value) if name == 'code' else _short(value)}"
    for i, (role, each) in enumerate(record.inputs.items()):
        last = i == len(record.inputs) - 1
        yield f"{margin}{'└─' if last else '├─'} {role}: {each.path}  {_hashes(each.sha256, each.key)}"
        yield from _input(out, each, margin + ("   " if last else "│  "), seen)


def _input(out: Path, each: Input, margin: str, seen: set[str]) -> Iterator[str]:
    if not each.artifact:
        yield f"{margin}   an external file"
        return
    record = read_record(out, each.path)
    if record is None:
        yield f"{margin}   no longer there, and without a record"
    elif record.sha256 != each.sha256:
        yield f"{margin}   replaced by another version, sha256 {record.sha256[:12]}…"
    else:
        yield from _maker(out, record, margin, seen)


def _hashes(sha256: str, key: str) -> str:
    return f"[sha256 {sha256[:12]}… key {key[:12]}…]"


def _code(value: str) -> str:
    """The hashes of the code and of the lock file."""
    code, lock = parts_of_code(value).values()
    return f"{code[:12]}… environment.lock {lock[:12]}…"


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False, sort_keys=True)
    return text if len(text) <= WIDTH else f"{text[:WIDTH]}… ({len(text)} characters; the manifest has all)"
