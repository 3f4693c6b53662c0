"""What is kept in an output folder, what comes from the store, and what must be made: keys alone decide."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import count
from pathlib import Path

from data_collection.console import counted
from workflow.artifacts.keys import output_key
from workflow.artifacts.manifest import CHANGED, MANIFEST
from workflow.artifacts.records import Record, content, contents, read_record, remove
from workflow.artifacts.store import Store
from workflow.execution.dag import Job, Plan, keys_of
from workflow.execution.progress import working_at

# The endings of texts, which people edit.
EDITED = (".csv", ".md", ".tex", ".html")


class Keeper:
    """Brings an output folder in line with a plan; its methods are hooks of `workflow.execution.engine`.

    Attributes:
        planned: The keys of the artifacts of a plan by path; empty until one is for real.
        whole: Whether these are all artifacts of the study.
        complete: False if an artifact was removed because its code changed.
    """

    def __init__(self, out: Path, store: Store) -> None:
        self.planned: dict[str, str] = {}
        self.whole = False
        self.complete = True
        self._out = out
        self._store = store
        self._keys: dict[str, str] = {}  # the job's key, by the path of each output

    def decide(self, plan: Plan) -> Collection[int]:
        """The jobs that must run: those with an artifact that is missing, stale or damaged, and not in the store.

        Stale and damaged artifacts are reported. If the plan is for real, they are removed, what the store has is put
        in place, and no artifact is left older than its inputs.
        """
        jobs, for_real = plan.jobs, plan.for_real
        with working_at(f"comparing the artifacts of {counted(len(jobs), 'job')} with their checksums"):
            keys = keys_of(jobs, cache(lambda path: content(Path(path)).sha256))
            judged = _judge(self._out, jobs, keys)
        for path in judged.damaged:
            _say(f"damaged: {path}, will be made again")
        for rule, number in judged.stale.items():
            _say(f"stale: {number} of rule {rule}, made by other code, settings or inputs")
        restored: list[int] = []
        needed: list[int] = []
        with working_at("looking for artifacts in the cache"):
            for i, (job, key) in enumerate(zip(jobs, keys, strict=True)):
                records = {path: judged.sound[path] for path in job.outputs.values() if path in judged.sound}
                if len(records) == len(job.outputs) and not job.forced:
                    if for_real:
                        self._store.put(key, self._out, records, only_if_room=True)
                else:
                    (restored if self._restored(job, key, for_real) else needed).append(i)
        if for_real:
            _order_times(self._out, jobs)
        kept = len(jobs) - len(restored) - len(needed)
        _say(
            f"artifacts of {kept} {'job' if kept == 1 else 'jobs'} are kept, of {len(restored)} come from the cache, "
            f"of {len(needed)} are made"
        )
        if for_real:
            self.whole = plan.whole
            self.planned = {
                path: output_key(key, role)
                for job, key in zip(jobs, keys, strict=True)
                for role, path in job.outputs.items()
            }
            self._keys = {path: key for job, key in zip(jobs, keys, strict=True) for path in job.outputs.values()}
            if restored or needed:
                (self._out / MANIFEST).unlink(missing_ok=True)  # it describes another state
        return needed

    def _restored(self, job: Job, key: str, for_real: bool) -> bool:
        """Whether the store has what a job makes; if for real, it is put in place, or nothing is."""
        if not for_real:
            return not job.forced and key in self._store
        for path in job.outputs.values():
            _set_aside(self._out, path)
            remove(self._out, path)
        return not job.forced and self._store.fetch(key, self._out, job.outputs)

    def finished(self, job: Job, same_code: bool = True) -> None:
        """Put the outputs of a job into the store, or remove them if its code has changed since it was planned."""
        if not same_code:
            self.complete = False
            _say(f"the code of rule {job.rule} changed while the study ran: what it made is removed; run again")
            for path in job.outputs.values():
                remove(self._out, path)
            return
        records = {path: read_record(self._out, path) for path in job.outputs.values()}
        as_planned = {
            path: record
            for role, path in job.outputs.items()
            if (record := records[path]) and record.key == output_key(self._keys[path], role)
        }
        if as_planned.keys() == records.keys() and as_planned:
            self._store.put(self._keys[next(iter(records))], self._out, as_planned)


@dataclass(frozen=True)
class _Judged:
    """The artifacts of a plan: records of the sound ones, the damaged ones, the number of stale ones by rule."""

    sound: dict[str, Record]
    damaged: list[str]
    stale: dict[str, int]


def _judge(out: Path, jobs: Sequence[Job], keys: Sequence[str]) -> _Judged:
    """Compare records with the keys of a plan, and artifacts with their records."""
    right: dict[str, Record] = {}
    stale: Counter[str] = Counter()
    for job, key in zip(jobs, keys, strict=True):
        for role, path in job.outputs.items():
            record = read_record(out, path)
            if record is not None and record.key == output_key(key, role):
                right[path] = record
            elif (out / path).exists():
                stale[job.rule] += 1
    found = {path: each.sha256 for path, each in contents(out, sorted(right)).items() if each is not None}
    sound = {path: record for path, record in right.items() if found.get(path) == record.sha256}
    return _Judged(sound, sorted(found.keys() - sound.keys()), dict(sorted(stale.items())))


def _order_times(out: Path, jobs: Sequence[Job]) -> None:
    """Let no artifact look older than its inputs, or Snakemake would make it again."""
    for job in jobs:
        newest = max((_time(out / path) for path in job.inputs.values()), default=0)
        for path in [out / path for path in job.outputs.values() if 0 < _time(out / path) < newest]:
            for each in (path, path / ".snakemake_timestamp"):  # Snakemake's time of a folder
                with suppress(OSError):
                    os.utime(each, ns=(newest, newest))


def _time(path: Path) -> int:
    """The time of a file or folder in nanoseconds, 0 if it does not exist."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _set_aside(out: Path, path: str) -> None:
    """Move what somebody edited to `OUT/changed`, for it may be work: a text, or files of an artifact's folder."""
    record, place = read_record(out, path), out / path
    if record is None:
        return
    if place.is_dir() and record.files is not None:
        own = content(place).files or {}
        edited = [f"{path}/{name}" for name, sha256 in own.items() if record.files.get(name) != sha256]
    else:
        # What is no text nobody edits: it is damaged.
        is_text = place.suffix in EDITED and place.is_file()
        edited = [path] if is_text and content(place).sha256 != record.sha256 else []
    for name in edited:
        aside = out / CHANGED / name
        for number in count(2):
            if not aside.exists():
                break
            aside = aside.with_name(f"{number}_{Path(name).name}")
        aside.parent.mkdir(parents=True, exist_ok=True)
        (out / name).rename(aside)
        _say(f"changed: {name} is now {aside.relative_to(out)}")


def _say(line: str) -> None:
    sys.stderr.write(f"{line}\n")
