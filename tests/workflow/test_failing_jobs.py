"""What is shown of a job that fails, however it does."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.synthetic import write_own_study
from tests.workflow.runs import copy_project, run
from workflow.execution.job import last_lines

PRINTS = "    for i in range(9):\n        print('step', i)\n"
LAST = "".join(f"    step {i}\n" for i in range(4, 9))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "says"),
    [
        ("    raise ValueError('no way')\n", f"ValueError: no way\n{LAST}(more in joblogs/fit/"),
        (
            "    import os, sys; sys.stdout.flush(); os.abort()\n",
            f"rule fit was ended by SIGABRT\n{LAST}(more in joblogs/fit/",
        ),
    ],
)
def test_its_last_lines_are_shown(tmp_path: Path, fault: str, says: str) -> None:
    project = copy_project(tmp_path / "project")
    script = project / "workflow" / "scripts" / "fit.py"
    text, opening = script.read_text(encoding="utf-8"), "with job(snakemake):\n"
    assert text.count(opening) == 1
    script.write_text(text.replace(opening, opening + PRINTS + fault), encoding="utf-8")
    printed = run(write_own_study(tmp_path, seeds=1, ROW=[0]), tmp_path / "out", succeeds=False, root=project)
    assert says in printed
    assert "Traceback" not in printed
    assert "stopped; what is done is kept" in printed


def test_last_lines_of_a_long_log(tmp_path: Path) -> None:
    log = tmp_path / "a.log"
    assert last_lines(log) == ""
    log.touch()
    assert last_lines(log) == ""
    log.write_text("".join(f"line {i}\n" for i in range(5000)) + "\u00e9nd", encoding="utf-8")
    assert last_lines(log, 2) == "    line 4999\n    \u00e9nd\n"
