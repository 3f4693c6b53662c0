"""Compiled code: its folder, one compilation for processes that start together, the same bytes everywhere."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from llvmlite import binding

import model
from model import compiled

# Prints a digest of two fits' traces, and the folder of the compiled code.
PROGRAM = """
import hashlib, numpy as np
from model import SAMPLERS, Problem, Trials, fit
from model.compiled import cache_folder
trials = Trials.from_arrays(np.eye(3), {"color": np.eye(3)}, [0, 1, 2], [0, 0, 0], [["a"], ["b", "a"], []])
digest = hashlib.sha256()
for kind in SAMPLERS.values():
    result = fit(Problem.of(trials, "proposed"), kind(iterations=20), np.random.default_rng(5))
    digest.update(result.trace_log_joint)
print(digest.hexdigest(), cache_folder())
"""

# Calls one compiled function; prints its result, and the folder of the compiled code.
ONE = """
import numpy as np
from model.compiled import cache_folder
from model.distributions.dirichlet import log_total
print(log_total(np.zeros(1)), cache_folder())
"""


def start(root: Path, program: str = PROGRAM, **environment: str) -> subprocess.Popen[str]:
    own = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    return subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=root,
        env={**own, "PYTHONPATH": str(root), "PYTHONDONTWRITEBYTECODE": "1", **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def result_of(process: subprocess.Popen[str]) -> list[str]:
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    return out.split()


def saved_by(lines: str) -> list[str]:
    """The files of machine code that a process under `NUMBA_DEBUG_CACHE` says it wrote."""
    return [os.path.normpath(path) for path in re.findall(r"data saved to '(.+?)'", lines)]


@pytest.mark.slow
def test_processes_that_start_together_compile_once(tmp_path: Path) -> None:
    root = Path(model.__file__).parents[1]
    together = [start(root, NUMBA_CACHE_DIR=str(tmp_path), NUMBA_DEBUG_CACHE="1") for _ in range(3)]
    printed = [process.communicate(timeout=600) for process in together]
    assert [process.returncode for process in together] == [0, 0, 0], printed
    results = [out.splitlines()[-1] for out, _ in printed]
    assert len(set(results)) == 1
    folder = Path(results[0].split()[1])
    assert folder.parent == tmp_path
    entries = {path: path.stat().st_mtime_ns for path in folder.rglob("*.nbc")}
    # Every signature of a function is saved by one of the processes; there are two where Numba compiles for literals.
    assert entries
    assert sorted(path for out, _ in printed for path in saved_by(out)) == sorted(map(str, entries))
    later = result_of(start(root, NUMBA_CACHE_DIR=str(tmp_path), OMP_NUM_THREADS="2", NUMBA_NUM_THREADS="2"))
    assert later == results[0].split()
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*.nbc")} == entries


def test_a_package_that_cannot_be_written_is_no_hindrance(tmp_path: Path) -> None:
    """Without a folder beside the package the user's is taken, and without that there is no cache."""
    package = tmp_path / "model"
    for name in ("model", "data_collection"):  # the latter writes files
        source = Path(model.__file__).parents[1] / name
        shutil.copytree(source, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "__pycache__").touch()  # A file where the folder should be; permissions do not stop every user.
    result, folder = result_of(start(tmp_path, ONE, XDG_CACHE_HOME=str(tmp_path / "home")))
    assert result == "0.0"
    assert Path(folder).is_relative_to(tmp_path / "home")
    assert list(Path(folder).rglob("dirichlet.log_total-*.nbc"))
    (tmp_path / "none").touch()
    assert result_of(start(tmp_path, ONE, XDG_CACHE_HOME=str(tmp_path / "none"))) == ["0.0", "None"]


def test_another_clone_finds_what_is_compiled(tmp_path: Path) -> None:
    """Also one that is seen through a link: the code is the same, and the path of its source says nothing of it."""
    root, cache = Path(model.__file__).parents[1], tmp_path / "cache"
    for name in ("model", "data_collection"):
        shutil.copytree(root / name, tmp_path / "copy" / name, ignore=shutil.ignore_patterns("__pycache__"))
        (tmp_path / "links").mkdir(exist_ok=True)
        (tmp_path / "links" / name).symlink_to(root / name)
    printed = [
        start(place, ONE, NUMBA_CACHE_DIR=str(cache), NUMBA_DEBUG_CACHE="1").communicate(timeout=600)[0]
        for place in (root, tmp_path / "copy", tmp_path / "links")
    ]
    assert [len(saved_by(one)) for one in printed] == [1, 0, 0]
    assert len({one.splitlines()[-1] for one in printed}) == 1


def test_the_folder_hangs_on_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "kernel.py").write_text("from model.compiled import compiled\n")
    (tmp_path / "plain.py").write_text("x = 1\n")
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "more.py").write_text("y = 1\n")
    digests = [compiled._digest(tmp_path)]
    # A module without compiled functions may define what they unpack.
    for name, text in (
        ("plain.py", "x = 2\n"),
        ("kernel.py", "from model.compiled import compiled \n"),
        ("inner/more.py", "y = 2\n"),
    ):
        (tmp_path / name).write_text(text)
        digests.append(compiled._digest(tmp_path))
    assert len(set(digests)) == 4
    changed = digests[-1]
    monkeypatch.setattr(binding, "get_host_cpu_name", lambda: "another")
    assert compiled._digest(tmp_path) != changed


def test_numbas_own_setting_is_left_alone() -> None:
    before = numba.config.CACHE_DIR

    @compiled.compiled
    def double(x: float) -> float:
        return 2.0 * x

    assert double(2.0) == 4.0
    assert before == numba.config.CACHE_DIR
