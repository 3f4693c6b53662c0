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
