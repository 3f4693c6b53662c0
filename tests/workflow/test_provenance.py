"""Hashes of code: what changes them, and what does not."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from evaluation.figures.catalogue import FIGURES
from workflow.artifacts import provenance
from workflow.artifacts.provenance import ROOT, code_is_unchanged, imported_files, rule_code

SCRIPTS = ROOT / "workflow" / "scripts"
FIT = "evaluation/figures/fit.py"
FIGURE_MODULES = {ROOT / figure.module for figure in FIGURES.values()}


def names(script: str) -> set[str]:
    return {path.relative_to(ROOT).as_posix() for path in imported_files(SCRIPTS / script)}


def test_imports_are_followed() -> None:
    fit = names("fit.py")
    assert {"workflow/scripts/fit.py", "model/__init__.py", "model/fits.py"} <= fit
    assert {"features/table.py", "data_collection/seeding.py"} <= fit
    assert not any(name.startswith("evaluation/") for name in fit)
    assert "evaluation/figures/fit.py" not in names("evaluate_learning.py")


def test_of_the_workflow_each_digest_holds_the_script_alone() -> None:
    for script in SCRIPTS.glob("*.py"):
        assert [name for name in names(script.name) if name.startswith("workflow/")] == [
            f"workflow/scripts/{script.name}"
        ]


def test_a_changed_template_changes_the_scripts_that_use_templates(monkeypatch: pytest.MonkeyPatch) -> None:
    scripts = ("report.py", "tables.py", "fit.py", "evaluate_learning.py")
    before = {script: rule_code(SCRIPTS / script) for script in scripts}
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + b" " * (path.name == "table.html"))
    provenance.code_hash.cache_clear()
    changed = [script for script in scripts if rule_code(SCRIPTS / script) != before[script]]
    monkeypatch.undo()
    provenance.code_hash.cache_clear()
    assert changed == ["report.py", "tables.py"]


READERS = ("__doc__", "getdoc", "getsource", "get_docstring", "use_attribute_docstrings")


def test_no_job_reads_docstrings() -> None:
    """They are in no digest."""
    modules = imported_files(*SCRIPTS.glob("*.py"), *FIGURE_MODULES)
    assert len(modules) > 80
    readers = {
        path.relative_to(ROOT).as_posix() for path in modules if any(name in path.read_text() for name in READERS)
    }
    assert not readers


@pytest.mark.parametrize("later", ["evaluation", "model"])
def test_earlier_stages_do_not_depend_on_later_ones(later: str) -> None:
    for script in ("calibrate.py", "collect.py", "perceive.py", "features.py", "own_features.py"):
        assert not any(name.startswith(f"{later}/") for name in names(script)), script


def test_every_script_is_found_in_a_rule() -> None:
    rules = "".join(path.read_text() for path in (ROOT / "workflow" / "rules").glob("*.smk"))
    for script in SCRIPTS.glob("*.py"):
        assert f'"../scripts/{script.name}"' in rules
        assert re.search(rf'code=tracked\("{script.name}"(, figure.module)?\)', rules), script


def test_no_module_is_imported_in_a_way_that_reading_imports_misses() -> None:
    """Relative imports, and imports by a name made at run time, would be left out of the hash.

    The one such import is that of a figure's module, which the rule of the figure gives to `tracked` as well.
    """
    importers = ("import_module", "__import__", "run_path", "run_module", "resolve_name")
    for path in imported_files(*SCRIPTS.glob("*.py"), *FIGURE_MODULES):
        for node in ast.walk(ast.parse(path.read_bytes())):
            assert not (isinstance(node, ast.ImportFrom) and node.level), path
            called = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            assert not called.endswith(importers) or path == SCRIPTS / "figure.py", path


def test_a_figure_depends_on_its_own_module_and_not_on_others() -> None:
    """A change of one figure draws that one again."""
    for figure in FIGURES.values():
        files = imported_files(SCRIPTS / "figure.py", ROOT / figure.module)
        assert ROOT / figure.module in files
    assert ROOT / "evaluation/figures/confusion.py" not in imported_files(SCRIPTS / "figure.py", ROOT / FIT)
    assert rule_code(SCRIPTS / "figure.py", FIT) != rule_code(SCRIPTS / "figure.py")
    assert code_is_unchanged(SCRIPTS / "figure.py", FIT)


def test_a_changed_import_changes_the_hash(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "__init__.py").write_text("")
    (tmp_path / "package" / "deep.py").write_text("x = 1\n")
    (tmp_path / "package" / "other.py").write_text("x = 1\n")
    (tmp_path / "package" / "near.py").write_text("from package import deep\n")
    script = tmp_path / "script.py"
    script.write_text("import os\nimport package.near\n")
    monkeypatch.setattr(provenance, "ROOT", tmp_path)

    def fresh() -> str:
        for function in (provenance.code_hash, provenance._files):
            function.cache_clear()
        return provenance.code_hash(script)

    before = fresh()
    (tmp_path / "package" / "other.py").write_text("x = 2\n")
    assert fresh() == before
    (tmp_path / "package" / "deep.py").write_text('"""Words."""\n\nx = (1)  # one\n"""A note."""\n')
    assert fresh() == before
    (tmp_path / "package" / "deep.py").write_text("x = 2\n")
    assert fresh() != before
    assert not provenance.code_is_unchanged(tmp_path / "none.py")
