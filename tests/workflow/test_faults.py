"""Kills, full disks and files that change, at every step of a tiny study: what is wrong is named and never used."""

from __future__ import annotations

import errno
import fcntl
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.workflow import tiny
from tests.workflow.disks import change, disk
from tests.workflow.moments import killed_at_each_step
from tests.workflow.tiny import files, given, plan
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.records import DamagedError
from workflow.artifacts.store import Store
from workflow.execution import runner
from workflow.execution.dag import Job
from workflow.execution.job import recorded
from workflow.execution.turns import turn_of_job, turn_of_run

Record = Callable[[str, object], None]


@pytest.fixture
def undisturbed(tmp_path: Path) -> dict[str, bytes]:
    """What the tiny study leaves."""
    assert tiny.run(tmp_path / "undisturbed" / "out", Store(tmp_path / "undisturbed" / "cache")) == 0
    return files(tmp_path / "undisturbed" / "out")


def before(kind: str, folder: Path) -> None:
    """What stands in a folder before a run that will be killed."""
    folder.mkdir()
    match kind:
        case "all from the cache":
            tiny.run(folder / "out", Store(folder / "cache"))
            shutil.rmtree(folder / "out")
        case "another study":
            tiny.run(folder / "out", Store(folder / "cache"), plan(seed=2))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["nothing", "all from the cache", "another study"])
def test_a_kill_at_every_step(
    tmp_path: Path,
    undisturbed: dict[str, bytes],
    record_property: Record,
    caplog: pytest.LogCaptureFixture,
    kind: str,
) -> None:
    """Before and after every change of the file system: nothing half is left, neither there nor in the cache."""
    before(kind, tmp_path / "template")
    place = tmp_path / "place"

    def begin() -> None:
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(tmp_path / "template", place)

    known = [undisturbed, files(tmp_path / "template" / "out")]
    tried, lost = 0, dict[str, str]()
    begin()
    for step in killed_at_each_step(lambda: tiny.run(place / "out", Store(place / "cache")), place):
        tried += 1
        half = [
            path
            for path, content in files(place / "out").items()
            if all(content != those.get(path) for those in known)
        ]
        status = tiny.run(place / "out", Store(place / "cache"))
        again: list[str] = []
        other = tiny.run(place / "other", Store(place / "cache"), after=again.append)
        same = [files(place / name) == undisturbed for name in ("out", "other")]
        if half or again or (status, other) != (0, 0) or not all(same) or list(place.glob("*/**/*.part")):
            lost[step] = f"half {half}, status {status} and {other}, same bytes {same}, made again {again}"
        begin()
    record_property("kills survived", f"{tried - len(lost)} of {tried}")
    assert tried > 50
    assert lost == {}
    assert "damaged" not in caplog.text


@pytest.mark.parametrize("kind", ["nothing", "all from the cache"])
def test_an_output_disk_that_is_full_at_every_page(
    tmp_path: Path,
    undisturbed: dict[str, bytes],
    record_property: Record,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    kind: str,
) -> None:
    """A disk of one page, of two, and so on until the study fits: that is said, and a run goes on from there."""
    monkeypatch.setattr(runner, "LEAST_ROOM", 3 * 2**12)
    tried, survived, status = 0, 0, 1
    while status != 0:
        tried += 1
        before(kind, tmp_path / str(tried))
        with disk(tmp_path / str(tried) / "disk", 4 * tried) as small:
            store = Store(tmp_path / str(tried) / "cache")
            status = tiny.run(small / "out", store)
            printed = capsys.readouterr().err
            left = files(small / "out").items()
            change(small, "size=1m")
            again = tiny.run(small / "out", store)
            good = all(content == undisturbed.get(path) for path, content in left) and again == 0
            said = status == 0 or "No space left on device" in printed or f"{small}/out: the disk is full" in printed
            survived += good and said and files(small / "out") == undisturbed
    record_property("full output disks survived", f"{survived} of {tried}")
    assert survived == tried > 10


def test_a_cache_that_is_full_at_every_page(
    tmp_path: Path, undisturbed: dict[str, bytes], record_property: Record, caplog: pytest.LogCaptureFixture
) -> None:
    """The study goes on without, and what came to be in the cache is whole."""
    tried, survived, full = 0, 0, True
    while full:
        tried += 1
        caplog.clear()
        with disk(tmp_path / f"cache{tried}", 4 * tried) as small:
            status = tiny.run(tmp_path / f"out{tried}", Store(small))
            full = f"{small}: the cache cannot be written (No space left on device); going on without" in caplog.text
            again = tiny.run(tmp_path / f"again{tried}", Store(small))
            outs = [tmp_path / f"{name}{tried}" for name in ("out", "again")]
            whole = "damaged" not in caplog.text
            survived += whole and (status, again) == (0, 0) and all(files(out) == undisturbed for out in outs)
    record_property("full caches survived", f"{survived} of {tried}")
    assert survived == tried > 8


def test_a_read_only_cache_is_used_and_left_as_it_is(
    tmp_path: Path, undisturbed: dict[str, bytes], caplog: pytest.LogCaptureFixture
) -> None:
    with disk(tmp_path / "cache", 1000) as cache:
        assert tiny.run(tmp_path / "first" / "out", Store(cache)) == 0
        damaged = next(file for file in cache.glob("??/*/0") if b"scores" in file.read_bytes()[:6])
        damaged.write_text("damaged")
        change(cache, "ro")
        held = files(cache)
        ran: list[str] = []
        assert tiny.run(tmp_path / "out", Store(cache), after=ran.append) == 0
        assert ran == ["scores"]
        assert "damaged entry of the cache" in caplog.text
        assert "it is not used, but cannot be removed" in caplog.text
        assert tiny.run(tmp_path / "out", Store(cache), plan(seed=2)) == 0
        assert caplog.text.count("cannot be written (Read-only file system); going on without") == 1
        assert tiny.run(tmp_path / "out", Store(cache)) == 0
        assert files(tmp_path / "out") == undisturbed
        assert files(cache) == held


@pytest.mark.parametrize("path", ["mcap/b.mcap", "fits/1.npz"])
def test_damage_between_making_and_reading(
    tmp_path: Path, undisturbed: dict[str, bytes], capsys: pytest.CaptureFixture[str], path: str
) -> None:
    out, store = tmp_path / "out", Store(tmp_path / "none", limit=0)
    maker, reader = ("collect", "fit") if "mcap" in path else ("fit", "scores")

    def damage(rule: str) -> None:
        if rule == maker:
            (out / path).write_bytes((out / path).read_bytes()[:-1])

    ran: list[str] = []

    def after(rule: str) -> None:
        damage(rule)
        ran.append(rule)

    assert tiny.run(out, store, after=after) == 1
    assert reader not in ran
    assert f"{path} is damaged: sha256" in capsys.readouterr().err
    assert not (out / "manifest.json").exists()
    ran.clear()
    assert tiny.run(out, store, after=ran.append) == 0
    assert ran[:2] == [maker, reader]
    assert files(out) == undisturbed


def with_source(source: Path) -> list[Job]:
    """The tiny plan, in which `collect` and `fit` read an external file."""
    jobs = plan()
    return [replace(job, inputs=job.inputs | {"source": str(source)}) for job in jobs[:2]] + jobs[2:]


@pytest.mark.parametrize("whole", [True, False], ids=["the study", "some targets"])
def test_a_file_from_elsewhere_that_changes_between_two_jobs(
    whole: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What was made of the other version says so, and is not taken for what it is not, here nor in the cache."""
    source, store = tmp_path / "source", Store(tmp_path / "cache")
    source.write_text("one")
    jobs = with_source(source)

    def change_it(rule: str) -> None:
        if rule == "collect":
            source.write_text("two")

    assert tiny.run(tmp_path / "out", store, jobs, after=change_it, whole=whole) == 1
    assert "changed while the study ran" in capsys.readouterr().err
    assert not (tmp_path / "out" / "manifest.json").exists()
    assert len(list(store.entries())) == 1
    for out in ("out", "undisturbed"):
        assert tiny.run(tmp_path / out, Store(tmp_path / "none", limit=0), jobs) == 0
    assert files(tmp_path / "out") == files(tmp_path / "undisturbed")
    source.write_text("one")
    assert tiny.run(tmp_path / "back", store, jobs) == 0
    assert b"one" in (tmp_path / "back" / "fits" / "1.npz").read_bytes()
    assert b"two" not in (tmp_path / "back" / "fits" / "1.npz").read_bytes()


def test_a_run_waits_for_the_jobs_of_a_killed_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = (
        "import sys, time, pathlib, workflow.execution.turns as turns\n"
        "out = pathlib.Path(sys.argv[1])\n"
        "with turns.turn_of_job(out):\n"
        "    print('begun', flush=True)\n"
        "    time.sleep(1)\n"
        "    (out / 'made').touch()\n"
    )
    line = [sys.executable, "-c", job, str(tmp_path)]
    with subprocess.Popen(line, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "begun\n"
        with turn_of_run(tmp_path) as alone:
            assert alone
            assert (tmp_path / "made").exists()
    assert f"{tmp_path}: waiting for the last jobs of a run that was killed" in capsys.readouterr().err


def test_a_folder_without_locks_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def no_locks(*_: object) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", no_locks)
    with turn_of_run(tmp_path) as alone, turn_of_job(tmp_path):
        assert alone
    assert f"{tmp_path}: cannot be locked" in capsys.readouterr().err


@pytest.mark.parametrize(
    "sign", [".artifacts", ".running"]
)  # before the first job has ended there is only the latter
def test_what_a_study_within_this_folder_is_writing_is_left_alone(tmp_path: Path, sign: str) -> None:
    own, inner = tmp_path / "out" / "fits" / ".1.npz.part", tmp_path / "out" / "smoke" / "fits" / ".1.npz.part"
    for part in (own, inner):
        part.parent.mkdir(parents=True)
        part.touch()
    (tmp_path / "out" / "smoke" / sign).mkdir()
    assert tiny.run(tmp_path / "out", Store(tmp_path / "cache")) == 0
    assert not own.exists()
    assert inner.exists()


def test_a_job_that_begins_after_the_next_run_ends(tmp_path: Path) -> None:
    with turn_of_run(tmp_path):
        with turn_of_job(tmp_path):
            pass
        with pytest.MonkeyPatch.context() as context:
            context.setenv("STUDY_RUN", "of an earlier run")
            with pytest.raises(SystemExit, match="another run has begun in this folder"), turn_of_job(tmp_path):
                pass


def test_a_file_from_elsewhere_that_changes_while_a_job_reads_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "source").write_text("one")
    with (
        pytest.raises(DamagedError, match="source changed while the job read it"),
        recorded(given(with_source(tmp_path / "source")[0])),
    ):
        (tmp_path / "source").write_text("two")
    assert not (tmp_path / ".artifacts").exists()
