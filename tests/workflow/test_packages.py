"""The four packages are the project's own, and depend in one direction."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path

import pytest

from workflow.provenance import ROOT

STAGES = ("data_collection", "features", "model", "evaluation")
ALLOWED = {
    "data_collection": set[str](),
    "features": {"data_collection"},
    "model": set[str](),
    "evaluation": {"data_collection", "features", "model"},
}


@pytest.mark.parametrize("package", STAGES)
def test_packages_resolve_to_the_project(package: str) -> None:
    """An installed package of the same name would win silently."""
    found = importlib.import_module(package).__file__
    assert found is not None
    assert Path(found).parent == ROOT / package


@pytest.mark.parametrize("package", STAGES)
def test_no_package_imports_a_later_stage(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            modules = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            modules += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            roots = {module.split(".")[0] for module in modules} & {*STAGES, "workflow"}
            assert roots - {package} <= ALLOWED[package], path


@pytest.mark.parametrize(
    ("library", "homes"), [("pybullet", "scene"), ("matplotlib", "figures*"), ("torch", "object_feature")]
)
def test_heavy_libraries_have_few_homes(library: str, homes: str) -> None:
    users = [
        path
        for package in STAGES
        for path in (ROOT / package).rglob("*.py")
        if any(line.split()[:2] in (["import", library], ["from", library]) for line in path.read_text().splitlines())
    ]
    assert users
    assert [path for path in users if not path.match(f"{homes}.py")] == []
