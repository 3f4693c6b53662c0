"""The packages are the project's own, and depend in one direction."""

from __future__ import annotations

import ast
import importlib
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

from workflow.artifacts.provenance import ROOT, imported_names

STAGES = ("data_collection", "features", "model", "evaluation")
MAY_IMPORT: dict[str, tuple[str, ...]] = {
    "data_collection": ("data_collection",),
    "data_collection/log": (
        "data_collection.log",
        "data_collection.files",
        "data_collection.joints",
        "data_collection.limits",
    ),
    "data_collection/simulator": (
        "data_collection.simulator",
        "data_collection.log",
        "data_collection.joints",
        "data_collection.apparatus",
        "data_collection.simulation_settings",
        "data_collection.strict_model",
        "data_collection.shapes",
        "data_collection.task",
    ),
    "data_collection/lerobot": ("data_collection.lerobot", "data_collection.log", "data_collection.joints"),
    "features": (
        "features",
        "data_collection.files",
        "data_collection.log",
        "data_collection.joints",
        "data_collection.limits",
        "data_collection.seeding",
        "data_collection.strict_model",
    ),
    "model": ("model", "data_collection.files", "data_collection.user_folders"),
    "model/distributions": ("model.distributions", "model.compiled", "model.data", "model.prior"),
    "model/kernels": (
        "model.kernels",
        "model.distributions",
        "model.compiled",
        "model.data",
        "model.frames",
        "model.frame_paths",
        "model.prior",
        "model.problem",
        "model.state",
    ),
    "model/samplers": (
        "model.samplers",
        "model.kernels",
        "model.distributions",
        "model.data",
        "model.joint",
        "model.methods",
        "model.problem",
        "model.state",
    ),
    "evaluation": ("evaluation", "model", "features", "data_collection"),
    "evaluation/uncertain": (
        "evaluation.uncertain",
        "evaluation.catalogue",
        "evaluation.generation",
        "evaluation.measures",
        "evaluation.scores",
        "evaluation.table_forms",
        "evaluation.tables",
        "model",
        "features",
        "data_collection.files",
    ),
    "evaluation/claims": (
        "evaluation.claims",
        "evaluation.catalogue",
        "evaluation.convergence",
        "evaluation.differences",
        "evaluation.measures",
        "evaluation.metrics",
        "evaluation.replicates",
        "evaluation.scores",
        "model",
        "features.table",
        "data_collection.seeding",
    ),
    "evaluation/figures": (
        "evaluation.figures",
        "evaluation.uncertain",
        "evaluation.confusion",
        "evaluation.generation",
        "evaluation.measures",
        "evaluation.replicates",
        "evaluation.scores",
        "model",
        "features",
        "data_collection",
    ),
    "evaluation/pages": (
        "evaluation.pages",
        "evaluation.templates",
        "evaluation.claims",
        "evaluation.figures",
        "evaluation.catalogue",
        "evaluation.convergence",
        "evaluation.data_sets",
        "evaluation.differences",
        "evaluation.effects",
        "evaluation.measures",
        "evaluation.scores",
        "evaluation.table_forms",
        "evaluation.variance",
        "model",
        "data_collection.files",
    ),
    "evaluation/talk": (
        "evaluation.talk",
        "evaluation.uncertain",
        "evaluation.acting",
        "evaluation.data_sets",
        "evaluation.description",
        "evaluation.generation",
        "evaluation.scores",
        "model",
        "features",
        "data_collection",
    ),
    "workflow/plan": ("workflow.plan", "evaluation", "model", "features", "data_collection"),
    "workflow/artifacts": (
        "workflow.artifacts",
        "data_collection.console",
        "data_collection.files",
        "data_collection.user_folders",
    ),
    "workflow/execution": (
        "workflow.execution",
        "workflow.artifacts",
        "workflow.plan",
        "data_collection.console",
        "model",
    ),
}
"""Folder → what it may import of the project."""
COMMANDS: dict[str, tuple[str, ...]] = {
    "model/__main__.py": ("data_collection.console", "data_collection.processor", "features.table"),
}
"""Command → what it may import beside that: it brings together what the modules of its folder know nothing of."""


@pytest.mark.parametrize("package", STAGES)
def test_packages_resolve_to_the_project(package: str) -> None:
    """An installed package of the same name would win silently."""
    found = importlib.import_module(package).__file__
    assert found is not None
    assert Path(found).parent == ROOT / package


def imported(path: Path) -> set[str]:
    """The dotted names of modules that a file imports from the project."""
    return {
        name
        for name in imported_names(ast.parse(path.read_text()))
        if name.split(".")[0] in {*STAGES, "workflow"}
        and (ROOT / name.replace(".", "/")).with_suffix(".py").is_file()
    }


@pytest.mark.parametrize(("folder", "allowed"), MAY_IMPORT.items())
def test_folders_depend_in_one_direction(folder: str, allowed: tuple[str, ...]) -> None:
    for path in (ROOT / folder).rglob("*.py"):
        for name in imported(path) - {*COMMANDS.get(path.relative_to(ROOT).as_posix(), ())}:
            assert name.startswith(tuple(f"{place}." for place in allowed)) or name in allowed, path


@pytest.mark.parametrize("package", [*STAGES, "workflow"])
def test_no_modules_import_each_other(package: str) -> None:
    names = {
        path: ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for path in sorted((ROOT / package).rglob("*.py"))
    }
    arrows = {name: imported(path) - {name} for path, name in names.items()}
    assert len(list(TopologicalSorter(arrows).static_order())) >= len(arrows)  # or raises CycleError


HOMES = {
    "pybullet": "data_collection/simulator/scene.py",
    "matplotlib": "evaluation/figures/*.py",
    "torch": "features/object_feature.py",
    "snakemake": "workflow/execution/*.py",
}


@pytest.mark.parametrize(("library", "home"), HOMES.items())
def test_heavy_libraries_have_few_homes(library: str, home: str) -> None:
    users = [
        path
        for package in (*STAGES, "workflow")
        for path in (ROOT / package).rglob("*.py")
        if library in {name.split(".")[0] for name in imported_names(ast.parse(path.read_text()))}
    ]
    assert users
    assert [path for path in users if not path.match(home)] == []
