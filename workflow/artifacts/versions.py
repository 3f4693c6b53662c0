"""The versions that the report shows."""

from __future__ import annotations

import hashlib
import re
import tomllib
from typing import Any

from workflow.artifacts.provenance import ROOT, code_hash

SCRIPTS = ("workflow/scripts", "evaluation/figures")


def study_hash() -> str:
    """sha256 of all scripts and figures and the project code that they import."""
    digest = hashlib.sha256()
    for script in sorted(path for folder in SCRIPTS for path in (ROOT / folder).glob("*.py")):
        digest.update(f"{script.name}\0{code_hash(script)}".encode())
    return digest.hexdigest()


def python_version() -> str:
    """The Python version that the project requires."""
    asked: str = _project()["requires-python"]
    return asked.removeprefix("==").removesuffix(".*")


def pinned_packages() -> dict[str, str]:
    """The locked version of each direct dependency, by name."""
    lines = (ROOT / "environment.lock").read_text(encoding="utf-8").splitlines()
    pinned = dict(line.split("==") for line in lines if re.match(r"[a-z0-9-]+==", line))
    names = (re.split(r"[^A-Za-z0-9-]", entry)[0] for entry in _project()["dependencies"])
    return {name: pinned[name] for name in sorted(names)}


def _project() -> dict[str, Any]:
    content: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return content
