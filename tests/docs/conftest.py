"""Folders in which a page's commands find what a reader's find."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from tests.docs.pages import ROOT
from tests.workflow.runs import SMOKE

COPIED = ("config", "docs")  # what a command may write to


@pytest.fixture
def repository(finished: Path, tmp_path: Path) -> Path:
    """The project's folder after a run, the smoke study in place of the study: what a reader stands in."""
    place = tmp_path / "repository"
    place.mkdir()
    for path in ROOT.iterdir():
        if path.name in COPIED:
            subprocess.run(["cp", "-a", str(path), str(place)], check=True)
        elif path.name not in ("results", ".venv", ".git"):
            (place / path.name).symlink_to(path)
    (place / ".venv").symlink_to(sys.prefix)
    (place / "config" / "config.yaml").write_text(SMOKE.read_text(encoding="utf-8"), encoding="utf-8")
    subprocess.run(["cp", "-a", str(finished), str(place / "results")], check=True)
    subprocess.run(["cp", "-a", str(finished), str(place / "results" / "smoke")], check=True)
    (place / "results" / "reference").symlink_to(ROOT / "results" / "reference")
    return place


@pytest.fixture
def environment(tmp_path: Path) -> Mapping[str, str]:
    """The environment variables of a reader who has set nothing, but has a cache of their own."""
    own = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    return {**own, "MPLBACKEND": "Agg", "CACHE": str(tmp_path / "cache")}


@pytest.fixture
def in_repository(repository: Path, environment: Mapping[str, str]) -> Callable[..., str]:
    """A function that runs a command in the reader's folder and returns what it prints."""

    def call(*arguments: str, succeeds: bool = True) -> str:
        done = subprocess.run(
            arguments, cwd=repository, env=dict(environment), capture_output=True, text=True, check=False
        )
        printed = done.stdout + done.stderr
        assert (done.returncode == 0) is succeeds, printed
        return printed

    return call


@pytest.fixture
def in_folder() -> Callable[..., str]:
    """A function that runs a command that fails, in a folder, and returns what it prints."""

    def call(folder: Path, *arguments: str, **variables: str) -> str:
        done = subprocess.run(
            arguments, cwd=folder, env={**os.environ, **variables}, capture_output=True, text=True, check=False
        )
        assert done.returncode != 0
        return done.stdout + done.stderr

    return call
