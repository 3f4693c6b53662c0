"""The smoke study with the newest Snakemake that pyproject.toml allows: whether an upgrade would do."""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.workflow.runs import SMOKE, command, hashes
from workflow.artifacts.provenance import ROOT

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of an environment of its own: the newest Snakemake, and what it needs, over the locked packages."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    [asked] = [each for each in project["dependencies"] if re.match(r"snakemake\W*[<>=]", each)]
    folder = tmp_path_factory.mktemp("newest")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    [packages] = folder.glob("lib/python*/site-packages")
    (packages / "locked.pth").write_text(sysconfig.get_path("purelib"))
    python = folder / "bin" / "python"
    line = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--upgrade", asked]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        pytest.skip(f"{asked} cannot be installed: {done.stderr.strip().splitlines()[-1]}")
    return python


def test_it_makes_the_same_bytes(
    python: Path, finished: Path, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    asked = [str(python), "-c", "import snakemake; print(snakemake.__version__)"]
    record_property("Snakemake", subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip())
    line = [str(python), *command(SMOKE, tmp_path / "out")[1:]]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert hashes(tmp_path / "out") == hashes(finished)
