"""Larger studies: their configs, and what they need."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import pandas as pd
import pytest
import yaml

from benchmarks.scale import larger, needs
from tests.conftest import STUDY
from workflow.artifacts.records import Record
from workflow.plan.loading import plan

ROOT = Path(__file__).parents[2]


def test_ten_times_the_study() -> None:
    config = yaml.safe_load(STUDY.read_text())
    before, after = (plan(each, STUDY) for each in (config, larger(config, 10, 10)))
    for name in after.experiments:
        fits = {(c.method, c.variant, c.sampler, c.D, c.ROW, c.seed) for c in after.conditions(name)}
        tenth = {(c.method, c.variant, c.sampler, 10 * c.D, c.ROW) for c in before.conditions(name)}
        assert {names[:5] for names in fits} == tenth
        assert len(fits) == 10 * len(list(before.conditions(name)))
        assert len(after.trials(name, "train")) == 10 * len(before.trials(name, "train"))
        shown = [own.figure_conditions(name) for own in (before, after)]
        assert {ending: 10 * one.D for ending, one in shown[0].items()} == {k: one.D for k, one in shown[1].items()}
        for task in ("generation", "description"):
            tested = {(c.D, c.ROW) for c in after.task_conditions(name, task)}
            assert tested == {(10 * c.D, c.ROW) for c in before.task_conditions(name, task)}


def test_seeds_that_a_config_leaves_open_are_multiplied_too() -> None:
    grown = larger({"experiments": {"own": {"D": [6]}}}, 1, 3)
    assert grown["experiments"]["own"] == {"D": [6], "seeds": 30}


def test_trials_that_are_simulated_are_multiplied_with_those_that_are_used() -> None:
    own = {"D": [6, 9], "trials": 12, "features": {"trials": "t.parquet"}, "variants": {"few": {"only": {"D": [6]}}}}
    grown = larger({"experiments": {"own": own}}, 2, 1)["experiments"]["own"]
    assert (grown["D"], grown["trials"]) == ([12, 18], 24)
    assert grown["variants"]["few"]["only"]["D"] == [12]
    assert grown["features"] == own["features"]


@pytest.mark.parametrize("factors", [(0, 1), (1, -2)])
def test_a_study_cannot_be_smaller_than_itself(factors: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="both must be at least 1"):
        larger({"experiments": {"own": {"D": [6]}}}, *factors)


def cells(page: str, first: str) -> list[str]:
    [line] = [line for line in page.splitlines() if line.startswith(f"| {first} |")]
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_what_is_shared_by_cores_and_what_is_not() -> None:
    stages = pd.DataFrame(
        [
            ("fit", 100, 720.0, 300.0),
            ("tables", 2, 90.0, 200.0),
            ("workflow", 1, 36.0, 400.0),
            ("report", 1, 0.036, 100.0),
        ],
        columns=["stage", "jobs", "processor", "memory"],
    )
    page = needs(stages, {"fits": 2**30, "figures": 2**29}, 1000)
    assert cells(page, "fit") == ["fit", "100", "7.2", "300", "0.2", "100,000", "200"]
    assert cells(page, "tables") == ["tables", "2", "45", "200", "0.025", "2", "25"]
    assert cells(page, "report") == ["report", "1", "0.036", "100", "1e-05", "1", "1e-05"]
    assert cells(page, "workflow") == ["workflow", "1", "36", "400", "0.01", "1", "10"]
    assert cells(page, "2") == ["2", "0.113", "113"]  # (720 + 90) / 2 seconds, and the report
    assert cells(page, "100") == ["100", "0.0125", "12.5"]  # a table takes more than 810 / 100 seconds
    assert cells(page, "figures") == ["figures", "0.5", "0.5"]
    assert cells(page, "all") == ["all", "1.5", "1,000"]


@pytest.mark.parametrize("manifest", [None, "{"])
def test_a_study_that_was_not_finished_is_named(tmp_path: Path, manifest: str | None) -> None:
    if manifest:
        (tmp_path / "manifest.json").write_text(manifest)
    line = [sys.executable, "-m", "benchmarks.scale", "needs", str(tmp_path)]
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert f"{tmp_path / 'manifest.json'} is" in done.stderr


def test_the_page_of_a_study(tmp_path: Path) -> None:
    log = tmp_path / "joblogs" / "fit" / "1.log"
    log.parent.mkdir(parents=True)
    log.write_text(f"took {json.dumps({'start_up': 0.1, 'processor': 7.2, 'wall': 8.0})}\n")
    record = Record("0", 3 * 2**30, "0", "fit", {}, {}, "fit")
    (tmp_path / "manifest.json").write_text(json.dumps({"artifacts": {"fits/a/1.npz": asdict(record)}}))
    line = [sys.executable, "-m", "benchmarks.scale", "needs", str(tmp_path), "--times", "10"]
    page = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert cells(page, "fit") == ["fit", "1", "7.2", "–", "0.002", "10", "0.02"]
    assert cells(page, "fits") == ["fits", "3", "30"]
    log.write_text("killed\n")
    done = subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{tmp_path}: no job has run here" in done.stderr
