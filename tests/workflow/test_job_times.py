"""The chart of where a study's time goes."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import pytest

from benchmarks.jobs import draw_job_times, job_times


def write_log(path: Path, **seconds: float) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"INFO a line\ntook {json.dumps(seconds)}\n", encoding="utf-8")


def test_seconds_by_stage(tmp_path: Path) -> None:
    write_log(tmp_path / "fit" / "seed1.log", start_up=0.5, processor=2.0, wall=3.0)
    write_log(tmp_path / "fit" / "seed2.log", start_up=0.5, processor=4.0, wall=3.0)
    write_log(tmp_path / "tables.log", start_up=1.0, processor=10.0, wall=3.0)
    (tmp_path / "scores.log").write_text("a job that was killed\n", encoding="utf-8")
    stages = job_times(tmp_path).set_index("stage")
    assert stages.index.tolist() == ["tables", "fit"]
    assert stages.loc["fit", ["jobs", "start_up", "work", "processor", "longest"]].tolist() == [2, 1, 5, 6, 4]
    assert stages.loc["fit", "share"] == pytest.approx(6 / 16)
    draw_job_times(stages.reset_index(), tmp_path / "jobs.png")
    picture = cv2.imread(str(tmp_path / "jobs.png"))
    assert picture is not None
    assert picture.std() > 10


def test_a_folder_without_logs_gives_no_rows(tmp_path: Path) -> None:
    assert job_times(tmp_path).empty
