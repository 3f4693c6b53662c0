"""What people give to make reaches the program as it is, and an environment is replaced only by one that stands."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FAKE = """#!/bin/sh
# A Python that makes environments with itself in them; pip fails where the folder has a file `broken`.
if [ "$1 $2" = "-m venv" ]; then mkdir -p "$3/bin" && cp "$0" "$3/bin/python" && echo own >"$3/own"; exit 0; fi
if [ "$1 $2" = "-m pip" ] && [ -f broken ]; then exit 7; fi
if [ "$1" = "-I" ]; then test -f same; exit $?; fi
exit 0
"""


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    for name in ("Makefile", "environment.lock"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(ROOT / ".ci", tmp_path / ".ci")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python3.11").write_text(FAKE)
    (tmp_path / "bin" / "python3.11").chmod(0o755)
    return tmp_path


def make(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {"PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}
    return subprocess.run(
        ["make", *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def set_up(folder: Path, succeeds: bool = True) -> str:
    done = make(folder, "setup")
    assert (done.returncode == 0) == succeeds, done.stderr
    return done.stdout


def lock_changes(folder: Path) -> None:
    with (folder / "environment.lock").open("a") as file:
        file.write("other==1.0\n")


def test_a_lock_that_is_only_newer_keeps_the_environment(clone: Path) -> None:
    assert "Setting up" in set_up(clone)
    (clone / ".venv" / "installed_by_hand").touch()
    os.utime(clone / "environment.lock", (2**32, 2**32))
    assert set_up(clone) == ""
    assert (clone / ".venv" / "installed_by_hand").exists()
    digest = hashlib.sha256((clone / "environment.lock").read_bytes()).hexdigest()
    assert (clone / ".venv" / ".ready").read_text().strip() == digest


def test_another_lock_makes_another_environment_and_keeps_the_one_before(clone: Path) -> None:
    set_up(clone)
    first = (clone / ".venv").resolve()
    (first / "installed_by_hand").touch()
    lock_changes(clone)
    assert "which is kept" in set_up(clone)
    assert (clone / ".venv").resolve() != first
    assert (first / "installed_by_hand").exists()
    shutil.copy(ROOT / "environment.lock", clone)
    assert "Setting up" not in set_up(clone)
    assert (clone / ".venv").resolve() == first


def test_a_set_up_that_fails_leaves_the_environment(clone: Path) -> None:
    set_up(clone)
    first = (clone / ".venv").resolve()
    lock_changes(clone)
    (clone / "broken").touch()
    set_up(clone, succeeds=False)
    assert (clone / ".venv").resolve() == first
    assert (first / "own").exists()
    (clone / "broken").unlink()
    assert "Setting up" in set_up(clone)


@pytest.mark.parametrize("same", [True, False])
def test_a_folder_of_an_earlier_set_up_is_kept(clone: Path, same: bool) -> None:
    (clone / ".venv" / "bin").mkdir(parents=True)
    shutil.copy(clone / "bin" / "python3.11", clone / ".venv" / "bin" / "python")
    (clone / ".venv" / "installed_by_hand").touch()
    (clone / ".venv" / ".ready").touch()
    if same:
        (clone / "same").touch()
    assert ("Setting up" in set_up(clone)) == (not same)
    kept = clone / (".venv" if same else ".venv-before")
    assert (kept / "installed_by_hand").exists()
    assert not kept.is_symlink()


NAMES = ["my results", "a; echo harm", "it's", "$HOME", "`id`", "$(id)", "a&b", "ü", '"', "my results results"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("target", ["study", "claims", "smoke", "verify", "compare", "snakemake-report"])
def test_names_reach_the_program_as_they_are(target: str, name: str) -> None:
    done = make(ROOT, "-n", target, f"OUT={name}", f"CONFIG={name}/c.yaml", "CORES=1; echo")
    words = shlex.split(done.stdout.splitlines()[-1])
    assert name in words
    if target == "study":
        assert [f"{name}/c.yaml", "1; echo"] == [
            words[words.index("--config") + 1],
            words[words.index("--cores") + 1],
        ]


def test_claims_are_run_until_they_are_decided_where_that_is_asked_for() -> None:
    words = shlex.split(make(ROOT, "-n", "claims", "UNTIL=30; echo").stdout.splitlines()[-1])
    assert words[words.index("--until-decided") + 1] == "30; echo"
    assert "--until-decided" not in make(ROOT, "-n", "claims").stdout


def test_results_are_removed_only_where_that_is_asked_for(clone: Path) -> None:
    (clone / "results" / "reference").mkdir(parents=True)
    (clone / "results" / "fits").mkdir()
    assert "results/fits" in make(clone, "clean").stdout
    assert (clone / "results" / "fits").exists()
    make(clone, "clean", "YES=1")
    assert [path.name for path in (clone / "results").iterdir()] == ["reference"]
