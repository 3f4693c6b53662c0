"""What a run keeps, restores and makes again: decided by keys and checksums alone."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.workflow import tiny
from tests.workflow.tiny import carry_out as carry_out_in
from tests.workflow.tiny import files, plan, work
from workflow.artifacts.keys import hash_of, output_key
from workflow.artifacts.manifest import verify
from workflow.artifacts.provenance import FORMAT, parts_of_code
from workflow.artifacts.records import DamagedError, read_record, record_path
from workflow.artifacts.store import Store
from workflow.execution.dag import Job, Plan, keys_of
from workflow.execution.keeping import Keeper

Run = Callable[..., list[str]]
EVERYTHING = ["collect", "fit", "scores"]


@pytest.fixture
def out(tmp_path: Path) -> Path:
    (tmp_path / "out").mkdir()
    return tmp_path / "out"


@pytest.fixture
def run(out: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Carry a plan out without a store; the rules of the jobs that ran."""

    def of(jobs: list[Job] | None = None) -> list[str]:
        keeper = Keeper(out, Store(out.parent / "none", limit=0))
        return carry_out_in(keeper, out, jobs or plan(), monkeypatch)

    return of


def test_keys_in_jobs_are_those_of_the_plan(run: Run, out: Path) -> None:
    assert run() == EVERYTHING
    jobs = plan()
    for job, key in zip(jobs, keys_of(jobs, str), strict=True):
        for role, path in job.outputs.items():
            record = read_record(out, path)
            assert record is not None
            assert record.key == output_key(key, role)
            assert record.explains_its_key()


# 2: libraries choose other kernels, which makes no difference here.
WRITTEN = dict.fromkeys((1, 2), "4c480f55db8cccc3154c4fd28e6e0057f94bd444c8a20a1aca7222a32ce3f4ab")


def test_what_the_machinery_writes_belongs_to_its_format(run: Run, out: Path) -> None:
    """No key holds the code of the machinery: raise `FORMAT` if this sha256 of artifacts and records is another."""
    run()
    written = {path: content.decode() for path, content in files(out).items()}
    assert hash_of([written, parts_of_code("a" * 64 + "b" * 64)]) == WRITTEN[FORMAT]


def test_nothing_runs_again(run: Run) -> None:
    run()
    assert run() == []


def test_times_of_files_do_not_matter(run: Run, out: Path) -> None:
    run()
    for age, path in enumerate(["scores.csv", "fits/1.npz", "mcap/b.mcap"]):
        os.utime(out / path, (1e9 + age, 1e9 + age))
    assert run() == []


def test_no_artifact_is_left_older_than_its_inputs(run: Run, out: Path) -> None:
    """Snakemake, and whoever runs it by hand, would make it again."""
    run()
    os.utime(out / "mcap/b.mcap", (2e9, 2e9))
    os.utime(out / "scores.csv", (1e9, 1e9))
    assert run() == []
    times = [(out / path).stat().st_mtime for path in ("mcap/b.mcap", "fits/1.npz", "fits/more", "scores.csv")]
    assert times == sorted(times)
    assert (out / "mcap/a.mcap").stat().st_mtime < 2e9


def test_a_setting_reruns_what_depends_on_it_and_back(
    run: Run, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run()
    before = (out / "scores.csv").read_text()
    assert run(plan(seed=2)) == EVERYTHING
    assert "stale: 2 of rule collect" in capsys.readouterr().err
    assert (out / "scores.csv").read_text() != before
    assert run() == EVERYTHING
    assert (out / "scores.csv").read_text() == before


def test_changed_code_of_a_late_stage_leaves_the_early_ones(run: Run) -> None:
    run()
    jobs = plan()
    jobs[2] = replace(jobs[2], parameters={"code": "other"})
    assert run(jobs) == ["scores"]


@pytest.mark.parametrize("path", ["fits/1.npz", "fits/more/two.txt"])
def test_a_damaged_artifact_is_named_and_made_again(
    run: Run, out: Path, capsys: pytest.CaptureFixture[str], path: str
) -> None:
    run()
    before = (out / path).read_text()
    (out / path).write_text(before[:-1] + "x")
    capsys.readouterr()
    assert run() == ["fit"]  # what follows has the right keys and stays
    assert f"damaged: {path.removesuffix('/two.txt')}, will be made again" in capsys.readouterr().err
    assert (out / path).read_text() == before


def test_what_somebody_changed_in_a_folder_is_set_aside(
    run: Run, out: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run()
    before = (out / "fits/more/two.txt").read_text()
    (out / "fits/more/form_ann.csv").write_text("much work")
    (out / "fits/more/two.txt").write_text("edited")
    capsys.readouterr()
    assert run() == ["fit"]
    said = capsys.readouterr().err
    for name, text in (("form_ann.csv", "much work"), ("two.txt", "edited")):
        assert (out / "changed/fits/more" / name).read_text() == text
        assert f"changed: fits/more/{name} is now changed/fits/more/{name}" in said
    assert (out / "fits/more/two.txt").read_text() == before
    (out / "fits/more/two.txt").write_text("edited again")
    assert run() == ["fit"]
    assert (out / "changed/fits/more/2_two.txt").read_text() == "edited again"
    assert verify(out)[1] == []


def test_a_table_that_somebody_edited_is_set_aside(run: Run, out: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run()
    before = (out / "scores.csv").read_text()
    (out / "scores.csv").write_text("with a note")
    capsys.readouterr()
    assert run() == ["scores"]
    assert "changed: scores.csv is now changed/scores.csv" in capsys.readouterr().err
    assert (out / "changed/scores.csv").read_text() == "with a note"
    assert (out / "scores.csv").read_text() == before
    # What nobody edits is damaged.
    (out / "fits/1.npz").write_text("no fit")
    assert run() == ["fit"]
    assert not (out / "changed/fits/1.npz").exists()
    # One that is made anew for another reason is no work of anybody's.
    jobs = plan()
    jobs[2] = replace(jobs[2], parameters={"code": "other"})
    assert run(jobs) == ["scores"]
    assert [path.name for path in (out / "changed").rglob("*") if path.is_file()] == ["scores.csv"]
    assert verify(out)[1] == []


@pytest.mark.parametrize("path", ["mcap/a.mcap", "fits/1.npz", ".artifacts/fits/1.npz.json"])
def test_what_is_missing_is_made_even_if_nothing_asks_for_it(run: Run, out: Path, path: str) -> None:
    run()
    (out / path).unlink()
    assert run() == ["collect" if "mcap" in path else "fit"]


def test_a_dry_run_changes_nothing(run: Run, out: Path) -> None:
    run()
    (out / "scores.csv").write_text("damaged")
    keeper = Keeper(out, Store(out.parent / "cache"))
    assert keeper.decide(Plan(plan(seed=2), for_real=False)) == [0, 1, 2]
    assert (out / "scores.csv").read_text() == "damaged"
    assert (out / "manifest.json").is_file()
    assert keeper.planned == {}


def test_a_job_names_a_damaged_input_and_removes_it(run: Run, out: Path) -> None:
    run()
    (out / "fits" / "1.npz").write_text("damaged")
    with pytest.raises(DamagedError, match=r"fits/1.npz is damaged: sha256 \w{12}…, but \w{12}… when it was made"):
        work(plan()[2])
    assert not (out / "fits" / "1.npz").exists()
    assert not record_path(out, "scores.csv").exists()
    assert run() == ["fit", "scores"]


def test_a_forced_job_runs_whatever_is_there(run: Run) -> None:
    run()
    jobs = plan()
    jobs[1] = replace(jobs[1], forced=True)
    assert run(jobs) == ["fit"]


def test_two_folders_share_through_the_store(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second folder is filled without a job, with the same bytes; and so is a config that was changed back."""
    store, other = Store(out.parent / "cache"), out.parent / "other"
    other.mkdir()
    assert carry_out_in(Keeper(out, store), out, plan(), monkeypatch) == EVERYTHING
    assert carry_out_in(Keeper(other, store), other, plan(), monkeypatch) == []
    files = [path.relative_to(out) for path in out.rglob("*") if path.is_file()]
    assert len(files) >= 7
    assert all((out / path).read_bytes() == (other / path).read_bytes() for path in files)
    (other / "scores.csv").write_text("edited in place")
    assert carry_out_in(Keeper(out, store), out, plan(), monkeypatch) == []
    assert carry_out_in(Keeper(other, store), other, plan(seed=2), monkeypatch) == EVERYTHING
    assert carry_out_in(Keeper(other, store), other, plan(), monkeypatch) == []
    assert all((out / path).read_bytes() == (other / path).read_bytes() for path in files)


def test_what_an_emptied_store_lost_is_put_back(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = Store(out.parent / "cache")
    carry_out_in(Keeper(out, store), out, plan(), monkeypatch)
    shutil.rmtree(store.folder)
    assert carry_out_in(Keeper(out, store), out, plan(), monkeypatch) == []
    assert len(list(store.entries())) == 3


def test_a_store_that_is_too_small_is_not_filled_again_by_a_run_without_jobs(tmp_path: Path) -> None:
    out, folder = tmp_path / "out", tmp_path / "cache"
    assert tiny.run(out, Store(folder)) == 0
    entries = sorted(Store(folder).entries(), key=lambda entry: entry.size)
    limit = entries[-1].size + 1
    assert tiny.run(out, Store(folder, limit)) == 0  # trims it
    left = {entry.folder: entry.folder.stat().st_ctime_ns for entry in Store(folder).entries()}
    assert 0 < len(left) < len(entries)
    assert tiny.run(out, Store(folder, limit)) == 0
    assert {entry.folder: entry.folder.stat().st_ctime_ns for entry in Store(folder).entries()} == left
