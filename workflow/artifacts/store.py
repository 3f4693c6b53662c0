"""The store: artifacts by key, in a folder that all of a user's clones, configs and output folders share.

An entry is a folder named by a job's key, with the job's outputs and their records. It is written under a temporary
name, renamed, and never changed, so that any number of processes can share the store without locks. Files go in and
out as copies, never as links: editing an artifact in place does not affect the store.
"""

from __future__ import annotations

import errno
import json
import logging
import os
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path

from workflow.artifacts.cache_options import DEFAULT_GIB
from workflow.artifacts.copies import copy, remove_any, share, temporary_name
from workflow.artifacts.keys import hash_of
from workflow.artifacts.records import FULL, Record, content, remove, write_record

ABANDONED = 24 * 3600.0  # seconds after which a temporary folder counts as left over from a killed process
_logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Entry:
    """An entry: its folder, its size in bytes, and when it was last used (seconds since the epoch)."""

    folder: Path
    size: int
    used: float


@dataclass
class Store:
    """A folder of entries.

    Attributes:
        folder: Where they are; created with the first entry.
        limit: The most bytes that `trim` leaves; 0 turns the store off.
    """

    folder: Path
    limit: int = int(DEFAULT_GIB * 2**30)
    _closed: set[str] = field(default_factory=set, repr=False)  # "written" or "read": what has failed
    _room: int | None = field(default=None, repr=False)  # bytes up to the limit, once somebody asked

    def __contains__(self, key: str) -> bool:
        return os.path.isfile(self._entry(key) / "entry.json")  # noqa: PTH113 (no error if it is not readable)

    def put(self, key: str, out: Path, records: Mapping[str, Record], only_if_room: bool = False) -> bool:
        """Store the outputs of a job.

        If the folder cannot be written, or is full, one warning says so and the study goes on without the store.

        Args:
            key: The job's key.
            out: The output folder.
            records: The records of all its outputs, by path in `out`.
            only_if_room: Whether to leave out what `trim` would only make room for by removing something.

        Returns:
            Whether the store has the entry now.
        """
        if self.limit == 0 or "written" in self._closed or key in self:
            return self.limit > 0 and key in self
        listing = {path: asdict(record) for path, record in sorted(records.items())}
        text = json.dumps({"outputs": listing, "sha256": hash_of(listing)})
        size = sum(record.size for record in records.values()) + len(text.encode())
        if only_if_room and not self._takes(size):
            return False
        temporary: Path | None = None
        try:
            (self.folder / "tmp").mkdir(parents=True, exist_ok=True)
            temporary = Path(tempfile.mkdtemp(dir=self.folder / "tmp"))
            for i, (path, record) in enumerate(sorted(records.items())):
                copy(out / path, temporary / str(i))
                if content(temporary / str(i)).sha256 != record.sha256:
                    return False  # changed since it was made; the next verification will say so
            (temporary / "entry.json").write_text(text, encoding="utf-8")
            share(temporary)
            self._entry(key).parent.mkdir(exist_ok=True)
            temporary.rename(self._entry(key))
        except OSError as error:
            if error.errno not in (errno.EEXIST, errno.ENOTEMPTY):  # then another process was faster
                self._close("written", error)
            return key in self
        finally:
            if temporary is not None:
                shutil.rmtree(temporary, ignore_errors=True)
        if self._room is not None:
            self._room -= size
        return True

    def fetch(self, key: str, out: Path, paths: Mapping[str, str]) -> bool:
        """Copy the outputs of a job and their records to the output folder.

        Each copy is compared with its checksum before it is moved into place. A damaged entry is reported in a
        warning, removed, and not used.

        Args:
            key: The job's key.
            out: The output folder.
            paths: The path in `out` of each output by role.

        Returns:
            Whether they are in place now.
        """
        entry = self._entry(key)
        if self.limit == 0 or "read" in self._closed or key not in self:
            return False
        try:
            listing = _listing(entry)
            numbers = {record.role: (i, record) for i, record in enumerate(listing)}
            if set(numbers) != set(paths):
                raise ValueError("other outputs than the job's")
            copies = []
            try:
                for role, path in paths.items():
                    number, record = numbers[role]
                    copies.append((temporary_name(out / path), path, record))
                    copy(entry / str(number), copies[-1][0])
                    if content(copies[-1][0]).sha256 != record.sha256:
                        raise ValueError(f"what would be {path} has another sha256")
                for copied, path, record in copies:
                    remove(out, path)
                    copied.rename(out / path)
                    write_record(out, path, record)
            finally:
                for copied, _, _ in copies:
                    remove_any(copied)
        except FileNotFoundError:
            if key in self:  # else another process has just cleaned it away
                self._damaged(entry, "a file is missing")
            return False
        except (ValueError, TypeError, KeyError) as error:
            self._damaged(entry, str(error))
            return False
        except OSError as error:
            if error.errno in FULL:  # what is written to is the output folder
                self._closed.add("read")
                _logger.warning("%s: no room for what the cache holds (%s)", out, error.strerror)
            else:
                self._close("read", error)
            return False
        with suppress(OSError):  # read-only: then nobody cleans up by age either
            os.utime(entry / "entry.json")
        return True

    def entries(self) -> Iterator[Entry]:
        """All entries, in no particular order."""
        for listing in self.folder.glob("??/*/entry.json"):
            try:
                size = sum(path.stat().st_size for path in listing.parent.rglob("*") if path.is_file())
                yield Entry(listing.parent, size, listing.stat().st_mtime)
            except FileNotFoundError:
                continue  # another process has just cleaned it away

    def trim(self, limit: int | None = None) -> tuple[int, int]:
        """Remove what killed processes left, and the least recently used entries beyond the limit.

        Args:
            limit: In bytes; None for the store's own, and then a store that is turned off is left alone.

        Returns:
            The numbers of entries and bytes removed.
        """
        if limit is None and self.limit == 0:
            return 0, 0
        limit = self.limit if limit is None else limit
        for left in self.folder.glob("tmp/*"):
            try:
                if time.time() - left.stat().st_mtime > ABANDONED:
                    shutil.rmtree(left, ignore_errors=True)
            except FileNotFoundError:
                continue
        entries = sorted(self.entries(), key=lambda entry: entry.used)
        total = sum(entry.size for entry in entries)
        count = freed = 0
        for entry in entries:
            if total - freed <= limit:
                break
            if self._drop(entry.folder):
                count, freed = count + 1, freed + entry.size
        return count, freed

    def _takes(self, size: int) -> bool:
        """Whether so many bytes more are within the limit, as far as this process knows."""
        if self._room is None:
            self._room = self.limit - sum(entry.size for entry in self.entries())
        return size <= self._room

    def _entry(self, key: str) -> Path:
        return self.folder / key[:2] / key

    def _damaged(self, entry: Path, what: str) -> None:
        removed = "and removed" if self._drop(entry) else "but cannot be removed"
        _logger.warning("%s: damaged entry of the cache (%s); it is not used, %s", entry, what, removed)

    def _drop(self, entry: Path) -> bool:
        """Remove an entry, whose name disappears first, so that nobody sees half of it."""
        try:
            (self.folder / "tmp").mkdir(exist_ok=True)
            away = Path(tempfile.mkdtemp(dir=self.folder / "tmp"))
            entry.rename(away / "entry")
            shutil.rmtree(away, ignore_errors=True)
        except OSError:
            return False
        return True

    def _close(self, what: str, error: OSError) -> None:
        self._closed.add(what)
        _logger.warning("%s: the cache cannot be %s (%s); going on without", self.folder, what, error.strerror)


def _listing(entry: Path) -> list[Record]:
    """The records of an entry, in the order of its files.

    Raises:
        ValueError, TypeError, KeyError: The listing is damaged.
    """
    data = json.loads((entry / "entry.json").read_text(encoding="utf-8"))
    if hash_of(data["outputs"]) != data["sha256"]:
        raise ValueError("its listing has another sha256")
    return [Record.from_mapping(each) for _, each in sorted(data["outputs"].items())]
