"""What a study was computed with, for people to read."""

from __future__ import annotations

import hashlib
import re
import tomllib
from typing import Any

from workflow.artifacts.provenance import ROOT, code_hash

SCRIPTS = ("workflow/scripts", "evaluation/figures")


def study_hash() -> str:
    """sha256 over every script of the workflow and every figure, with all project code that they import."""
    digest = hashlib.sha256()
    for script in sorted(path for folder in SCRIPTS for path in (ROOT / folder).glob("*.py")):
        digest.update(f"{script.name}\0{code_hash(script)}".encode())
    return digest.hexdigest()


def python_version() -> str:
    """The Python that the project asks for."""
    asked: str = _project()["requires-python"]
    return asked.removeprefix("==").removesuffix(".*")


def pinned_packages() -> dict[str, str]:
    """The version in environment.lock of each package that the project depends on, by name."""
    lines = (ROOT / "environment.lock").read_text(encoding="utf-8").splitlines()
    pinned = dict(line.split("==") for line in lines if re.match(r"[a-z0-9-]+==", line))
    names = (re.split(r"[^A-Za-z0-9-]", entry)[0] for entry in _project()["dependencies"])
    return {name: pinned[name] for name in sorted(names)}


def _project() -> dict[str, Any]:
    content: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return content
