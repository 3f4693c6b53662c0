"""What is kept of an output folder, what is taken from the store, and what must be made: the keys alone decide."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Collection, Sequence
from functools import cache
from pathlib import Path

from workflow.dag import Job, keys_of
from workflow.keys import output_key
from workflow.manifest import MANIFEST
from workflow.records import Content, Record, content, contents, read_record, remove
from workflow.store import Store


class Keeper:
    """Keeps an output folder in accord with a plan; its methods are the hooks of `workflow.dag`.

    Attributes:
        artifacts: the paths of all artifacts of the plan that was carried out, None before one was.
    """

    def __init__(self, out: Path, store: Store) -> None:
        self.artifacts: list[str] | None = None
        self._out = out
        self._store = store
        self._keys: dict[str, str] = {}  # of jobs, by each output's path

    def decide(self, jobs: Sequence[Job], for_real: bool) -> Collection[int]:
        """The jobs that must run: those of which an artifact is missing, stale or damaged, and not in the store.

        What is stale or damaged is said; for real it is also removed, and what the store has is put in place.
        """
        keys = keys_of(jobs, cache(lambda path: content(Path(path)).sha256))
        records = {path: read_record(self._out, path) for job in jobs for path in job.outputs.values()}
        right = {
            path
            for job, key in zip(jobs, keys, strict=True)
            for role, path in job.outputs.items()
            if (record := records[path]) and record.key == output_key(key, role)
        }
        found = contents(self._out, sorted(right))
        sound = {path for path in right if _is(found[path], records[path])}
        stale: Counter[str] = Counter()
        restored: list[int] = []
        needed: list[int] = []
        for i, (job, key) in enumerate(zip(jobs, keys, strict=True)):
            paths = set(job.outputs.values())
            if paths <= sound and not job.forced:
                if for_real and key not in self._store:
                    self._store.put(key, self._out, {path: record for path in paths if (record := records[path])})
                continue
            for path in sorted(paths - sound):
                if path in right and found[path] is not None:
                    _say(f"damaged: {path}, will be made again")
                elif path not in right and (self._out / path).exists():
                    stale[job.rule] += 1
            if for_real:
                for path in paths:
                    remove(self._out, path)
                fetched = not job.forced and self._store.fetch(key, self._out, job.outputs)
            else:
                fetched = not job.forced and key in self._store
            (restored if fetched else needed).append(i)
        for rule, count in sorted(stale.items()):
            _say(f"stale: {count} of rule {rule}, made by other code, settings or inputs")
        _say(f"{len(jobs) - len(restored) - len(needed)} jobs' artifacts are kept, "
             f"{len(restored)} come from the cache, {len(needed)} are to be made")  # fmt: skip
        if for_real:
            self.artifacts = [path for job in jobs for path in job.outputs.values()]
            self._keys = {path: key for job, key in zip(jobs, keys, strict=True) for path in job.outputs.values()}
            if restored or needed:
                (self._out / MANIFEST).unlink(missing_ok=True)  # it speaks of another state
        return needed

    def finished(self, job: Job) -> None:
        """Put what a job has made into the store."""
        records = {path: read_record(self._out, path) for path in job.outputs.values()}
        as_planned = {
            path: record
            for role, path in job.outputs.items()
            if (record := records[path]) and record.key == output_key(self._keys[path], role)
        }
        if as_planned.keys() == records.keys() and as_planned:
            self._store.put(self._keys[next(iter(records))], self._out, as_planned)


def _is(found: Content | None, record: Record | None) -> bool:
    return found is not None and record is not None and found.sha256 == record.sha256


def _say(line: str) -> None:
    sys.stderr.write(f"{line}\n")
