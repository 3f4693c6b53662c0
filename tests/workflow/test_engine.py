"""What Snakemake is asked to run, and what of Snakemake is used for it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.synthetic import write_own_study
from tests.workflow.runs import copy_project, hashes, run
from workflow.artifacts.provenance import ROOT
from workflow.execution import engine
from workflow.execution.dag import Job


@pytest.mark.slow
def test_what_is_missing_is_made_and_nothing_else(tmp_path: Path) -> None:
    """Whatever was touched, and although Snakemake would make again what lies between the missing artifacts."""
    config, out = write_own_study(tmp_path, methods=["mmlda"], seeds=1, ROW=[0]), tmp_path / "out"
    run(config, out)
    shutil.rmtree(f"{out}.cache")
    made = hashes(out)
    shutil.rmtree(out / "features")
    (out / "scores.csv").unlink()
    for number, fit in enumerate(sorted(out.glob("fits/**/*.npz"))):
        os.utime(fit, times=(0, time.time() + 1000 * number))
    logs = {path: path.stat().st_mtime_ns for path in out.glob("joblogs/**/*.log")}
    table = dict(re.findall(r"^(\w+) +(\d+)$", run(config, out, "--dry-run"), flags=re.MULTILINE))
    assert table == {"own_features": "1", "scores": "1", "total": "2"}
    assert "2 of 2 jobs done (100%)" in run(config, out)
    assert hashes(out) == made
    changed = {path.relative_to(out).parts[1] for path, at in logs.items() if path.stat().st_mtime_ns != at}
    assert changed == {"own_features", "scores.log", "workflow.log"}


@pytest.mark.slow
def test_questions_are_answered_and_nothing_is_run(tmp_path: Path) -> None:
    config, out = write_own_study(tmp_path, methods=["mmlda"], seeds=1, ROW=[0]), tmp_path / "out"
    assert re.search(r"^scores.csv\t-\t.*\tmissing\tupdate pending$", run(config, out, "--summary"), re.MULTILINE)
    assert "own_features" in run(config, out, "--list-rules")
    assert "no_such" in run(config, out, "no_such", succeeds=False)
    assert "unrecognized arguments: --no-such" in run(config, out, "--no-such", succeeds=False)
    assert hashes(out) == {}


def test_what_nobody_promises_of_snakemake_is_listed(tmp_path: Path) -> None:
    project = copy_project(tmp_path)
    shutil.copytree(ROOT / ".ci", project / ".ci")

    def listed() -> subprocess.CompletedProcess[str]:
        line = [sys.executable, str(project / ".ci" / "private_names")]
        return subprocess.run(line, capture_output=True, text=True, check=False)

    assert listed().returncode == 0, listed().stdout
    plugins = project / "workflow" / "execution" / "plugins.py"
    plugins.write_text(f"{plugins.read_text()}\n\ndef patch(dag):\n    dag.finish = dag._needrun\n")
    found = listed()
    assert found.returncode == 1
    assert "dag._needrun: not allowed" in found.stdout
    assert "dag.finish (replaced): not allowed" in found.stdout


def test_a_stage_of_many_rules_is_forced_by_its_name() -> None:
    """Each block of trials is a rule: nobody is to write all of their names."""
    jobs = [
        Job(f"collect_a_train_{first}_to_{first + 1}", {}, {}, {}, {}, f"joblogs/collect/a/train_{first}.log")
        for first in (1, 3)
    ]
    jobs.append(Job("fit", {}, {}, {}, {}, "joblogs/fit/a/b.log"))
    asked = {"collect", "fit", "tables/a.csv"}
    assert engine.forced_stages(asked) == {"collect"}  # the others are Snakemake's own
    assert engine.forced_stages(None) == set()
    assert [job.forced for job in engine.forced(jobs, {"collect"})] == [True, True, False]
    with pytest.raises(ValueError, match="--forcerun figures: this study has no such job"):
        engine.forced(jobs, {"figures"})
