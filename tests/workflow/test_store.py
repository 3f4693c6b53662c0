"""The store: what comes out is what went in, or nothing."""

from __future__ import annotations

import logging
import multiprocessing
import os
import time
from pathlib import Path

import pytest

from workflow.artifacts.cache_options import default_folder, default_limit
from workflow.artifacts.keys import job_key
from workflow.artifacts.records import Record, content, read_record, records_of_job
from workflow.artifacts.store import Store
from workflow.command_line import WRONG, main

OUTPUTS = {"table": "features/t.parquet", "logs": "mcap"}


def made(out: Path, name: str = "a") -> tuple[str, dict[str, Record]]:
    """The files and records of a job, and its key."""
    (out / "features").mkdir(parents=True, exist_ok=True)
    (out / "features" / "t.parquet").write_text(f"table {name}")
    (out / "mcap").mkdir(exist_ok=True)
    (out / "mcap" / "1.mcap").write_text(f"log {name}")
    parameters = {"code": name}
    return job_key("rule", {}, parameters, {}), records_of_job(out, "rule", {}, parameters, {}, OUTPUTS)


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "cache")


def test_what_is_put_is_fetched(store: Store, tmp_path: Path) -> None:
    key, records = made(tmp_path / "out")
    assert key not in store
    assert store.put(key, tmp_path / "out", records)
    assert key in store
    assert store.fetch(key, tmp_path / "other", OUTPUTS)
    for path in OUTPUTS.values():
        assert content(tmp_path / "other" / path) == content(tmp_path / "out" / path)
        assert read_record(tmp_path / "other", path) == records[path]
    assert not store.fetch("0" * 64, tmp_path / "other", OUTPUTS)


def test_nothing_is_linked(store: Store, tmp_path: Path) -> None:
    key, records = made(tmp_path / "out")
    store.put(key, tmp_path / "out", records)
    store.fetch(key, tmp_path / "other", OUTPUTS)
    for folder in (store.folder, tmp_path / "out", tmp_path / "other"):
        files = [path for path in folder.rglob("*") if path.is_file()]
        assert files
        assert all(path.stat().st_nlink == 1 and not path.is_symlink() for path in files)


@pytest.mark.parametrize("damage", ["file", "folder", "listing", "truncated listing", "lost"])
def test_a_damaged_entry_is_named_removed_and_never_used(
    store: Store, tmp_path: Path, caplog: pytest.LogCaptureFixture, damage: str
) -> None:
    key, records = made(tmp_path / "out")
    store.put(key, tmp_path / "out", records)
    entry = store.folder / key[:2] / key
    numbers = {path: i for i, path in enumerate(sorted(records))}
    match damage:
        case "file":
            (entry / str(numbers["features/t.parquet"])).write_text("table b")
        case "folder":
            (entry / str(numbers["mcap"]) / "2.mcap").write_text("one more")
        case "listing":
            text = (entry / "entry.json").read_text()
            (entry / "entry.json").write_text(text.replace('"rule": "rule"', '"rule": "other"'))
        case "truncated listing":
            (entry / "entry.json").write_text((entry / "entry.json").read_text()[:100])
        case "lost":
            (entry / str(numbers["features/t.parquet"])).unlink()
    with caplog.at_level(logging.WARNING):
        assert not store.fetch(key, tmp_path / "other", OUTPUTS)
    assert f"{key}: damaged entry of the cache" in caplog.text
    assert key not in store
    assert [path for path in (tmp_path / "other").rglob("*") if path.is_file()] == []
    assert store.put(key, tmp_path / "out", records)
    assert store.fetch(key, tmp_path / "other", OUTPUTS)


def test_an_artifact_that_changed_since_is_not_put(store: Store, tmp_path: Path) -> None:
    key, records = made(tmp_path / "out")
    (tmp_path / "out" / "features" / "t.parquet").write_text("edited")
    assert not store.put(key, tmp_path / "out", records)
    assert key not in store
    assert list((store.folder / "tmp").iterdir()) == []


def test_a_folder_that_cannot_be_written_is_named_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "file").write_text("no folder")
    store = Store(tmp_path / "file" / "cache")
    for name in ("a", "b"):
        key, records = made(tmp_path / "out", name)
        assert not store.put(key, tmp_path / "out", records)
        assert not store.fetch(key, tmp_path / "other", OUTPUTS)
    assert caplog.text.count("cannot be written") == 1
    assert store.trim() == (0, 0)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_store_is_read(store: Store, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    key, records = made(tmp_path / "out")
    store.put(key, tmp_path / "out", records)
    for path in [store.folder, *store.folder.rglob("*")]:
        path.chmod(0o555 if path.is_dir() else 0o444)
    assert store.fetch(key, tmp_path / "other", OUTPUTS)
    assert caplog.text == ""
    other, records = made(tmp_path / "out", "b")
    assert not store.put(other, tmp_path / "out", records)
    assert "cannot be written" in caplog.text
    for path in [store.folder, *store.folder.rglob("*")]:
        path.chmod(0o755)


def test_a_full_disk_leaves_no_half_entry(
    store: Store, tmp_path: Path, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(source: Path, target: Path) -> None:
        Path(target).write_text("hal")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("workflow.artifacts.store.shutil.copyfile", full)
    key, records = made(tmp_path / "out")
    assert not store.put(key, tmp_path / "out", records)
    assert "No space left on device" in caplog.text
    assert key not in store
    assert list((store.folder / "tmp").iterdir()) == []


def test_the_least_recently_used_go_first(store: Store, tmp_path: Path) -> None:
    keys = []
    for i, name in enumerate("abc"):
        key, records = made(tmp_path / name, name)
        store.put(key, tmp_path / name, records)
        os.utime(store.folder / key[:2] / key / "entry.json", (1000 + i, 1000 + i))
        keys.append(key)
    size = max(entry.size for entry in store.entries())
    assert store.fetch(keys[0], tmp_path / "other", OUTPUTS)  # used now
    count, freed = store.trim(2 * size)
    assert (count, freed > 0) == (1, True)
    assert [key in store for key in keys] == [True, False, True]
    assert store.trim(0)[0] == 2
    assert list(store.entries()) == []


def test_what_killed_processes_left_is_cleaned_away_when_old(store: Store) -> None:
    for name, age in (("old", 2 * 24 * 3600), ("young", 60)):
        (store.folder / "tmp" / name).mkdir(parents=True)
        os.utime(store.folder / "tmp" / name, (time.time() - age, time.time() - age))
    store.trim()
    assert [path.name for path in (store.folder / "tmp").iterdir()] == ["young"]


def _hammer(folder: Path, out: Path, failures: multiprocessing.Queue[str]) -> None:
    store = Store(folder)
    for round_ in range(30):
        key, records = made(out, str(round_ % 3))
        store.put(key, out, records)
        if store.fetch(key, out / "fetched", OUTPUTS):
            for path, record in records.items():
                if content(out / "fetched" / path).sha256 != record.sha256:
                    failures.put(path)
        if round_ % 7 == 0:
            store.trim(0)


def test_many_processes_share_a_store(tmp_path: Path) -> None:
    """Putting, fetching and cleaning at the same time: nobody ever gets other bytes, nobody fails."""
    context = multiprocessing.get_context("fork")
    failures: multiprocessing.Queue[str] = context.Queue()
    processes = [
        context.Process(target=_hammer, args=(tmp_path / "cache", tmp_path / f"out{i}", failures)) for i in range(4)
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert [process.exitcode for process in processes] == [0] * 4
    assert failures.empty()


def test_off(tmp_path: Path) -> None:
    store = Store(tmp_path / "cache", limit=0)
    key, records = made(tmp_path / "out")
    assert not store.put(key, tmp_path / "out", records)
    assert not store.fetch(key, tmp_path / "out", OUTPUTS)
    assert not (tmp_path / "cache").exists()


def test_a_store_that_is_off_leaves_what_is_there(store: Store, tmp_path: Path) -> None:
    key, records = made(tmp_path / "out")
    assert store.put(key, tmp_path / "out", records)
    assert Store(store.folder, limit=0).trim() == (0, 0)
    assert key in store


def test_where_it_is_and_how_large(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CACHE", str(tmp_path / "named"))
    assert default_folder() == tmp_path / "named"
    monkeypatch.delenv("CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    assert default_folder() == tmp_path / "xdg" / "cross-situational-learning" / "artifacts"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert default_folder() == tmp_path / ".cache" / "cross-situational-learning" / "artifacts"
    monkeypatch.setenv("CACHE_GIB", "0.5")
    assert default_limit() == 2**29
    for wrong in ("much", "-1", "inf", "nan"):
        monkeypatch.setenv("CACHE_GIB", wrong)
        with pytest.raises(ValueError, match=f"CACHE_GIB={wrong}: must be a number of gibibytes"):
            default_limit()


def test_a_size_to_clean_to_is_read_like_the_limit(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    for wrong in ("much", "-1", "inf", "nan"):
        monkeypatch.setattr("sys.argv", ["workflow", "cache-clean", "--cache", str(tmp_path), "--to", wrong])
        assert main() == WRONG
        assert capsys.readouterr().err == f"--to={wrong}: must be a number of gibibytes, 0 to empty the cache\n"
    monkeypatch.setattr("sys.argv", ["workflow", "cache-clean", "--cache", str(tmp_path), "--to", "0.5"])
    assert main() == 0
    assert capsys.readouterr().out == f"{tmp_path}: no jobs removed, 0.0 MiB freed\n"


def test_a_full_store_takes_nothing_that_it_would_only_remove_again(store: Store, tmp_path: Path) -> None:
    keys = {name: made(tmp_path / name, name) for name in "abc"}
    for name in "ab":
        assert store.put(*put(keys[name], tmp_path / name), only_if_room=True)
    full = Store(store.folder, limit=sum(entry.size for entry in store.entries()) + 1)
    assert not full.put(*put(keys["c"], tmp_path / "c"), only_if_room=True)
    assert full.trim() == (0, 0)
    assert full.put(*put(keys["c"], tmp_path / "c"))  # what was just made comes in for the least recently used
    assert full.trim()[0] == 1
    assert keys["c"][0] in full


def put(one: tuple[str, dict[str, Record]], out: Path) -> tuple[str, Path, dict[str, Record]]:
    """The arguments of `Store.put`."""
    return one[0], out, one[1]


def test_room_is_counted_as_it_is_filled(store: Store, tmp_path: Path) -> None:
    first, second = (made(tmp_path / name, name) for name in "ab")
    store.put(*put(first, tmp_path / "a"))
    (entry,) = store.entries()
    assert store.trim(0)[0] == 1
    room = Store(store.folder, limit=2 * entry.size - 1)
    assert room.put(*put(first, tmp_path / "a"), only_if_room=True)
    assert not room.put(*put(second, tmp_path / "b"), only_if_room=True)


def test_a_group_may_share_it(store: Store, tmp_path: Path) -> None:
    """With umask 002 and a folder that gives its group to what is made in it, another member may clean up."""
    store.folder.mkdir()
    store.folder.chmod(0o2775)
    before = os.umask(0o002)
    try:
        key, records = made(tmp_path / "out")
        store.put(key, tmp_path / "out", records)
    finally:
        os.umask(before)
    entry = store.folder / key[:2] / key
    assert entry.stat().st_mode & 0o7777 == entry.parent.stat().st_mode & 0o7777 == 0o2775
    assert all(file.stat().st_mode & 0o020 for file in entry.iterdir())


def test_without_a_home_folder_there_is_no_cache(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("data_collection.user_folders.Path.home", no_home)
    assert default_folder() is None
    assert main(["cache-info"]) == 0
    said = capsys.readouterr()
    assert said.out == f"{os.devnull}: no jobs, 0.0 MiB of at most 0.0 MiB\n"
    assert "CACHE or --cache names a folder" in said.err


def no_home() -> Path:
    raise RuntimeError("Could not determine home directory.")
