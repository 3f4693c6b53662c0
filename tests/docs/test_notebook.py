"""The notebook runs from its first cell to its last, and draws. Jupyter is not needed."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.docs.pages import ROOT

NOTEBOOK = ROOT / "docs" / "example.ipynb"
# Counts the figures when all cells are done.
LAST = '\nimport matplotlib.pyplot\nprint("figures:", len(matplotlib.pyplot.get_fignums()))\n'


def cells() -> list[dict[str, Any]]:
    """The cells with code."""
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def test_the_notebook_is_small_and_holds_no_outputs() -> None:
    assert NOTEBOOK.stat().st_size < 300_000
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells())


@pytest.mark.slow
@pytest.mark.parametrize("folder", [".", "docs"])
def test_the_notebook_runs(folder: str, repository: Path, environment: Mapping[str, str]) -> None:
    """Both from the project's folder, and from its own, as Jupyter does."""
    code = "\n".join("".join(cell["source"]) for cell in cells()) + LAST
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=repository / folder, env=dict(environment), capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "figures: 5" in done.stdout
    assert "simulator, D = 6" in done.stdout


def test_it_runs_where_there_is_no_jupyter(tmp_path: Path) -> None:
    """As a script that prints what cells give and saves the figure of each."""
    sources = ["x = 20\nx + 1\n", "import matplotlib.pyplot as plt\nplt.subplots()\nplt.subplots()\nx + 2;"]
    cells_ = [{"cell_type": "code", "source": source.splitlines(keepends=True)} for source in sources]
    (tmp_path / "a.ipynb").write_text(json.dumps({"cells": [{"cell_type": "markdown", "source": ["# A"]}, *cells_]}))
    script = [sys.executable, str(ROOT / "docs" / "run_notebook.py"), "pictures", "--notebook", "a.ipynb"]
    done = subprocess.run(script, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "21\n2 figures in pictures\n"
    assert sorted(path.name for path in (tmp_path / "pictures").iterdir()) == ["1.png", "2.png"]
