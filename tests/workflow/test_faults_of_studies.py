"""Kills, full disks, damage and edits while a real study runs: it ends with the bytes of an undisturbed one."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml

from tests.synthetic import write_own_study
from tests.workflow.disks import change, disk
from tests.workflow.runs import SMOKE, hashes, jobs, run, start, wait_until
from workflow.artifacts.manifest import read_manifest
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.records import record_path

pytestmark = pytest.mark.slow
Record = Callable[[str, object], None]
KILLS = 20


@dataclass(frozen=True)
class Kill:
    """A moment at which a study is killed.

    Attributes:
        records: When there are so many records of artifacts in the output folder, and
        seconds: So much later.
        group: The whole process group; otherwise Snakemake alone, whose jobs live on as orphans.
    """

    records: int
    seconds: float
    group: bool

    def do(self, out: Path, cache: Path) -> int:
        """Start a study and kill it then; its process group, in which orphans may live."""
        with start(SMOKE, out, cache=cache, output=subprocess.DEVNULL) as process:
            wait_until(lambda: records(out) >= self.records, process, patience=900)
            time.sleep(self.seconds)
            assert process.poll() is None, f"the study ended before {self}"
            (os.killpg if self.group else os.kill)(process.pid, signal.SIGKILL)
        return process.pid


def records(out: Path) -> int:
    return sum(1 for _ in (out / ".artifacts").rglob("*.json"))


def moments(count: int) -> list[Kill]:
    """Twenty moments of a study of so many artifacts, each drawn from a seed."""
    rng = random.Random("kills")
    at = sorted(rng.sample(range(count * 9 // 10), KILLS))
    return [Kill(number, rng.uniform(0, 1.5), group=i % 4 != 3) for i, number in enumerate(at)]


def test_a_study_is_killed_again_and_again(finished: Path, tmp_path: Path, record_property: Record) -> None:
    """Nothing that stands under its name is half; orphans do no harm; the end is the same, also from the cache."""
    out, cache = tmp_path / "out", tmp_path / "cache"
    undisturbed, lost, groups = hashes(finished), [], []
    for kill in moments(len(read_manifest(finished))):
        groups.append(kill.do(out, cache))
        half = sorted(hashes(out).items() - undisturbed.items())
        lost += [f"{kill}: {half}"] if half else []
    run(SMOKE, out, cache=cache)
    for group in groups:
        with suppress(ProcessLookupError):
            os.killpg(group, signal.SIGKILL)
    same = hashes(out) == undisturbed and not list(out.rglob("*.part"))
    record_property("kills survived", f"{(KILLS - len(lost)) * same} of {KILLS}")
    assert lost == []
    assert same
    assert (out / "manifest.json").read_bytes() == (finished / "manifest.json").read_bytes()
    run(SMOKE, tmp_path / "other", cache=cache)
    assert jobs(tmp_path / "other") == {}
    assert hashes(tmp_path / "other") == undisturbed


@dataclass(frozen=True)
class Own:
    """A finished study of features of one's own, the quickest that there is: its config, output folder and cache."""

    config: Path
    out: Path
    cache: Path


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Own:
    folder = tmp_path_factory.mktemp("own")
    config = write_own_study(folder, methods=["mmlda"], seeds=1, ROW=[0])
    run(config, folder / "out", cache=folder / "cache")
    return Own(config, folder / "out", folder / "cache")


def test_full_disks(own: Own, tmp_path: Path) -> None:
    """First both are full, then the cache alone."""
    with disk(tmp_path / "out", 1200) as small, disk(tmp_path / "cache", 100) as cache:
        printed = run(own.config, small / "out", cache=cache, succeeds=False)
        assert f"{cache}: the cache cannot be written (No space left on device); going on without" in printed
        assert f"{small}/out" in printed
        assert "is full; make room and run again, which goes on from here" in printed
        assert "Traceback" not in printed
        assert hashes(small / "out").items() < hashes(own.out).items()
        change(small, "size=20m")
        printed = run(own.config, small / "out", cache=cache)
        assert "No space left on device" in printed
        assert hashes(small / "out") == hashes(own.out)
        assert (small / "out" / "manifest.json").read_bytes() == (own.out / "manifest.json").read_bytes()


def test_an_output_disk_without_any_room(own: Own, tmp_path: Path) -> None:
    with disk(tmp_path / "full", 100) as full:
        printed = run(own.config, full / "out", cache=own.cache, succeeds=False)
    assert printed.startswith(f"{full}/out: the disk is full")
    assert len(printed.splitlines()) == 1


def fits_in(cache: Path) -> list[Path]:
    """The entries of fits in a cache."""
    return [file.parent for file in sorted(cache.glob("??/*/entry.json")) if '"rule": "fit"' in file.read_text()]


def test_a_read_only_cache_with_damage(own: Own, tmp_path: Path) -> None:
    with disk(tmp_path / "cache", 20_000) as cache:
        shutil.copytree(own.cache, cache, dirs_exist_ok=True)
        lost, damaged = fits_in(cache)
        shutil.rmtree(lost)
        (damaged / "0").write_bytes((damaged / "0").read_bytes()[:-1])
        change(cache, "ro")
        before = {path: path.read_bytes() for path in cache.rglob("*") if path.is_file()}
        printed = run(own.config, tmp_path / "out", cache=cache)
        assert jobs(tmp_path / "out") == {"fit": 2}
        assert f"{damaged}: damaged entry of the cache" in printed
        assert printed.count("the cache cannot be written (Read-only file system); going on without") == 1
        assert hashes(tmp_path / "out") == hashes(own.out)
        assert {path: path.read_bytes() for path in cache.rglob("*") if path.is_file()} == before


def test_an_artifact_is_damaged_as_soon_as_it_is_made(own: Own, tmp_path: Path) -> None:
    out, table = tmp_path / "out", "features/own/D20/train_trials.parquet"
    with start(own.config, out) as process:
        wait_until(lambda: record_path(out, table).is_file(), process)
        (out / table).write_bytes((out / table).read_bytes()[:-1])
        printed, _ = process.communicate()
    assert process.returncode == 1
    assert f"{table} is damaged: sha256" in printed
    assert not (out / "fits").exists() or not list(out.glob("fits/**/*.npz"))
    run(own.config, out)
    assert hashes(out) == hashes(own.out)


def test_the_config_is_edited_while_the_study_runs(own: Own, tmp_path: Path) -> None:
    """The running study does not see it, not even what is no config; the next one does."""
    for path in own.config.parent.glob("*.*"):
        shutil.copy(path, tmp_path)
    config, out = tmp_path / own.config.name, tmp_path / "out"
    edited = yaml.safe_load(config.read_text())
    edited["samplers"]["published"]["iterations"] += 1
    with start(config, out) as process:
        wait_until((out / ".snakemake").is_dir, process)
        config.write_text("{")
        wait_until(lambda: records(out) > 0, process)
        config.write_text(yaml.safe_dump(edited))
        printed, _ = process.communicate()
    assert process.returncode == 0, printed
    assert hashes(out) == hashes(own.out)
    assert (out / ".config.yaml").read_text() == own.config.read_text()
    run(config, out)
    assert jobs(out)["fit"] == 2
    assert {path for path, sha256 in hashes(out).items() if sha256 != hashes(own.out)[path]} >= {
        path for path in hashes(out) if path.startswith("fits/")
    }


def test_a_table_is_edited_while_the_study_runs(own: Own, tmp_path: Path) -> None:
    """One of two jobs has read it: the study says so, and the next run is as if the table had always been that."""
    config, out = write_own_study(tmp_path, methods=["mmlda"], seeds=1, ROW=[0], D=[10, 20]), tmp_path / "out"
    made = [f"features/own/D{D}/train_trials.parquet" for D in (10, 20)]
    with start(config, out, "--cores", "1") as process:
        wait_until(lambda: any(record_path(out, path).is_file() for path in made), process)
        trials = (tmp_path / "trials.parquet").read_bytes()
        write_own_study(tmp_path, truth=False, methods=["mmlda"], seeds=1, ROW=[0], D=[10, 20])
        printed, _ = process.communicate()
    assert "changed while the study ran" in printed
    assert process.returncode == 1
    assert (tmp_path / "trials.parquet").read_bytes() != trials
    assert not (out / "manifest.json").exists()
    run(config, out, "--until", "own_features")
    run(config, tmp_path / "undisturbed", "--until", "own_features")
    assert {path: hashes(out)[path] for path in hashes(tmp_path / "undisturbed")} == hashes(tmp_path / "undisturbed")


def clone_in(folder: Path) -> Path:
    """A clone of the project, with what compilers left."""
    folder.mkdir()
    packages = ("data_collection", "features", "model", "evaluation", "workflow")
    for part in (*packages, "Snakefile", "environment.lock", "pyproject.toml"):
        subprocess.run(["cp", "-a", str(ROOT / part), str(folder)], check=True)
    return folder


def test_code_is_edited_while_the_study_runs(own: Own, tmp_path: Path) -> None:
    """What jobs of that code made is not kept under the key of the other code, here or in the cache."""
    clone, out, cache = clone_in(tmp_path / "clone"), tmp_path / "out", tmp_path / "cache"
    with start(own.config, out, "--until", "fit", cache=cache, root=clone) as process:
        wait_until(lambda: records(out) > 0, process)
        with (clone / "model" / "fits.py").open("a") as file:
            file.write("EDITED = True\n")
        printed, _ = process.communicate()
    assert process.returncode == 1
    assert "the code of rule fit changed while the study ran: what it made is removed; run again" in printed
    assert jobs(out) == {"own_features": 1, "fit": 2}
    assert not list(out.glob("fits/**/*.npz"))
    assert fits_in(cache) == []
    run(own.config, out, "--until", "fit", cache=cache)
    assert jobs(out)["fit"] == 2


def test_two_clones_share_a_cache_at_the_same_time(own: Own, tmp_path: Path) -> None:
    clones = [clone_in(tmp_path / name) for name in ("one", "two")]
    running = [start(own.config, clone / "out", cache=tmp_path / "cache", root=clone) for clone in clones]
    for clone, process in zip(clones, running, strict=True):
        printed, _ = process.communicate()
        assert process.returncode == 0, printed
        assert "damaged" not in printed
        assert hashes(clone / "out") == hashes(own.out)
    run(own.config, tmp_path / "third", cache=tmp_path / "cache")
    assert jobs(tmp_path / "third") == {}
    assert hashes(tmp_path / "third") == hashes(own.out)
