"""A method that somebody adds: a row in the table of methods."""

from __future__ import annotations

from pathlib import Path

import pytest

from model import METHODS
from tests.synthetic import write_own_study
from tests.workflow.runs import copy_project, run
from workflow.plan.schema import config_schema


def test_the_schema_knows_the_methods() -> None:
    assert config_schema()["$defs"]["MethodName"]["enum"] == list(METHODS)


@pytest.mark.slow
def test_a_method_is_a_row(tmp_path: Path) -> None:
    project, out = copy_project(tmp_path / "project"), tmp_path / "out"
    table = project / "model" / "methods.py"
    text, last = table.read_text(encoding="utf-8"), "    )\n}\n"
    assert text.count(last) == 1
    table.write_text(
        text.replace(last, f'        Method("free", "(F) free", Independent()),\n{last}'), encoding="utf-8"
    )
    files = {"trials": "trials.parquet", "objects": "objects.parquet"}
    own = {"features": files | {"description": files}, "methods": ["free", "no_mec2"], "seeds": 1, "ROW": [0]}
    run(write_own_study(tmp_path, **own), out, root=project)
    table_of_learning = (out / "tables" / "own_csl.md").read_text(encoding="utf-8")
    assert "(F) free" in table_of_learning
    assert (out / "figures" / "own_confusion_free.png").stat().st_size > 1000
    assert "own_confusion_free.png" in (out / "report.html").read_text(encoding="utf-8")
