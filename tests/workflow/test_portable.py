"""The same bytes on every processor: jobs have their pins, and the pins are what it takes."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from data_collection.processor import PINNED, pin, pinned
from tests.workflow.portable import ALL_FOREIGN, PINS, different, study
from tests.workflow.runs import SMOKE, hashes
from workflow.artifacts.provenance import ROOT

# Writes arrays of some kinds, and prints the sha256 of the file.
WRITE = """
import hashlib, sys, numpy as np
from pathlib import Path
from data_collection.files import write_arrays
path = Path(sys.argv[1])
write_arrays(path, {"x": np.arange(3000.0), "names": np.array(["a", "bc"]), "empty": np.empty((0, 2)), "one": 1})
print(hashlib.sha256(path.read_bytes()).hexdigest())
"""


def test_other_tunables_stay() -> None:
    given = pinned({"GLIBC_TUNABLES": "glibc.malloc.arena_max=1:glibc.cpu.hwcaps=AVX2", "PATH": "/bin"})
    tunables = given["GLIBC_TUNABLES"].split(":")
    assert tunables[0] == "glibc.malloc.arena_max=1"
    assert len(tunables) == 2
    assert {"-FMA", "-AVX2"} < set(tunables[1].removeprefix("glibc.cpu.hwcaps=").split(","))
    assert given.items() > PINNED.items()
    assert "PATH" not in given
    environment = {"PATH": "/bin", "OPENBLAS_CORETYPE": "Zen"}
    pin(environment)
    assert environment == {"PATH": "/bin", **pinned({})}


def test_every_pin_belongs_to_a_library() -> None:
    named = {name for pins in PINS.values() for name in pins}
    assert named == {name for name in pinned({}) if not name.endswith("_NUM_THREADS")}


def test_libraries_do_as_they_are_told() -> None:
    """Each says by itself what it has chosen."""
    text = (
        "import cv2, numpy, torch\nfrom threadpoolctl import threadpool_info\nnumpy.linalg.svd(numpy.eye(3))\n"
        "print({one['architecture'] for one in threadpool_info() if 'architecture' in one})\n"
        "print(torch.backends.cpu.get_cpu_capability())\nprint('*AVX?' in cv2.getCPUFeaturesLine())\n"
        "print([name for name, has in numpy._core._multiarray_umath.__cpu_features__.items()\n"
        "       if has and name in numpy._core._multiarray_umath.__cpu_dispatch__])\n"
    )
    environment = {**os.environ, **ALL_FOREIGN}
    pin(environment)
    done = subprocess.run([sys.executable, "-c", text], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["{'Nehalem'}", "DEFAULT", "True", "[]"]


def test_arrays_have_the_same_bytes_under_another_python(tmp_path: Path) -> None:
    other = Path("/usr/bin/python3.11")
    if not other.is_file() or other.resolve() == Path(sys.executable).resolve():
        pytest.skip("no other Python 3.11 here")
    packages = [str(ROOT), *(path for path in sys.path if path.endswith("site-packages"))]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(packages)}
    found = [
        subprocess.run(
            [str(python), "-c", WRITE, str(tmp_path / "arrays.npz")],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for python in (sys.executable, other)
    ]
    assert found[0] == found[1]
    assert len(found[0].strip()) == len(hashlib.sha256().hexdigest())


@pytest.mark.slow
def test_a_study_is_the_same_wherever_it_starts(finished: Path, tmp_path: Path) -> None:
    assert different(hashes(finished), study(SMOKE, tmp_path / "out", foreign=ALL_FOREIGN)) == {}


@pytest.mark.slow
def test_without_the_pins_it_is_not(finished: Path, tmp_path: Path) -> None:
    """So that the test above has something to find: logs and percepts hang on the processor's own kernels."""
    if " avx2 " not in Path("/proc/cpuinfo").read_text(encoding="utf-8"):
        pytest.skip("this processor has nothing beyond what is pinned")
    all_pins = tuple(name for pins in PINS.values() for name in pins)
    found = different(hashes(finished), study(SMOKE, tmp_path / "out", without=all_pins))
    assert {"mcap", "percepts"} <= set(found)
