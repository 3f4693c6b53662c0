"""The manifest of a finished study, which lists every artifact with its record, and its verification."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path

from data_collection.console import counted
from data_collection.files import write_text
from workflow.artifacts.records import FOLDER, Content, Record, await_record, contents

MANIFEST = "manifest.json"
# What an output folder holds besides artifacts: logs, committed results, benchmarks.
CHANGED = "changed"  # where a run moves files that somebody changed in an artifact's folder
NO_ARTIFACTS = ("joblogs", "reference", "bench", "snakemake_report.html", CHANGED, MANIFEST)


def write_manifest(out: Path, artifacts: Mapping[str, str], patience: float = 30.0) -> None:
    """Write the records of artifacts to one file, sorted by path.

    Args:
        out: The output folder.
        artifacts: The planned key of each, by path.
        patience: Seconds to wait for records that another machine wrote and a shared file system shows late.

    Raises:
        ValueError: An artifact has no record, or its key differs from the planned one.
    """
    records = records_as_planned(out, artifacts, patience)
    entries = {path: asdict(record) for path, record in records.items()}
    text = json.dumps({"artifacts": entries}, sort_keys=True, indent=1, ensure_ascii=False)
    write_text(out / MANIFEST, text + "\n")


def records_as_planned(out: Path, artifacts: Mapping[str, str], patience: float = 30.0) -> dict[str, Record]:
    """The records of artifacts by path, if they were made of what the run began with; arguments of `write_manifest`.

    Raises:
        ValueError: An artifact has no record, or its key differs from the planned one.
    """
    records = {}
    unplanned = []
    until = time.monotonic() + patience
    for path in sorted(artifacts):
        record = await_record(out, path, until - time.monotonic())
        if record is None:
            raise ValueError(f"{path} has no record (does its script run in `with job(snakemake)`?)")
        records[path] = record
        unplanned += [path] if record.key != artifacts[path] else []
    if unplanned:
        many = counted(len(unplanned), "artifact is", "artifacts are")
        raise ValueError(
            f"a file, a setting or code changed while the study ran: {many} made of something else than it began "
            f"with (the first: {unplanned[0]}); run again, and they are made anew"
        )
    return records


def read_manifest(out: Path) -> dict[str, Record]:
    """The records of a manifest by path.

    Raises:
        ValueError: It is missing or damaged.
    """
    try:
        data = json.loads((out / MANIFEST).read_text(encoding="utf-8"))
        return {path: Record.from_mapping(each) for path, each in data["artifacts"].items()}
    except FileNotFoundError:
        why = "the study was never run to its end" if out.is_dir() else f"there is no folder {out}"
        raise ValueError(f"{out / MANIFEST} is missing: {why}") from None
    except OSError as error:
        raise ValueError(f"{out / MANIFEST} cannot be read: {error.strerror}") from error
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise ValueError(f"{out / MANIFEST} is damaged ({error}): run the study again to have it written") from error


def verify(out: Path) -> tuple[int, list[str]]:
    """Hash every artifact again.

    Returns:
        The number of artifacts in the manifest, and one line per artifact that is missing, changed or unexplained.

    Raises:
        ValueError: The manifest is missing or damaged.
    """
    manifest = read_manifest(out)
    found = contents(out, sorted(manifest))
    problems = []
    for path, record in manifest.items():
        problems += [f"{kind}: {path}{more}" for kind, more in _problems(manifest, record, found[path])]
    problems += [f"unexplained: {path} (not in the manifest)" for path in _others(out, set(manifest))]
    return len(manifest), sorted(problems)


def _problems(manifest: dict[str, Record], record: Record, found: Content | None) -> Iterator[tuple[str, str]]:
    if found is None:
        yield "missing", ""
    elif found.sha256 != record.sha256:
        yield "changed", f" (sha256 {found.sha256[:12]}…, made as {record.sha256[:12]}…)" + _files(record, found)
    if not record.explains_its_key():
        yield "unexplained", " (its key does not follow from what the manifest says of it)"
    for role, each in record.inputs.items():
        if each.artifact and each.path not in manifest:
            yield "unexplained", f" (made from {each.path}, which is not in the manifest)"
        elif each.artifact and manifest[each.path].sha256 != each.sha256:
            yield "unexplained", f" (made from another version of {each.path}, its input {role})"


def _files(record: Record, found: Content) -> str:
    """The files of a folder that differ."""
    if record.files is None or found.files is None:
        return ""
    names = sorted(record.files.keys() | found.files.keys())
    return ": " + ", ".join(name for name in names if record.files.get(name) != found.files.get(name))


def _others(out: Path, known: set[str], folder: str = "") -> Iterator[str]:
    """The files of an output folder that belong to no known artifact and to no study in a subfolder."""
    for each in sorted((out / folder).iterdir()):
        path = f"{folder}{each.name}"
        if path in known or each.name.startswith(".") or path in NO_ARTIFACTS:
            continue
        if not each.is_dir() or each.is_symlink():
            yield path
        elif not (each / FOLDER).is_dir():
            yield from _others(out, known, f"{path}/")
