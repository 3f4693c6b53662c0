"""Several data sets of an experiment: the first is what it is without the others, and each has draws of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import yaml

from data_collection.episode import calibrate, collect
from data_collection.log.mcap_log import Log
from data_collection.log_differences import differences
from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation
from evaluation.data_sets import data_set_name
from model import load
from tests.synthetic import OBJECTS_COLUMNS, TRIALS_COLUMNS, own_rows, write_own_study, write_rows
from tests.workflow.configs import FILE, minimal
from tests.workflow.runs import SMOKE, run
from workflow.execution.dag import Job
from workflow.execution.engine import planned
from workflow.plan.loading import plan

# What is told of the study as a whole is made of all data sets.
OF_ALL = {"scores", "convergence", "tables", "claims", "report"}


def jobs_with(folder: Path, **more: Any) -> list[Job]:
    config = yaml.safe_load(SMOKE.read_text(encoding="utf-8"))
    config["experiments"]["simulator"] |= more
    config["experiments"]["again"] = {"D": [6], "data": "simulator", "seeds": 1}
    folder.mkdir()
    (folder / "config.yaml").write_text(yaml.safe_dump(config))
    return planned(folder / "config.yaml", folder / "out")


def test_the_first_data_set_is_planned_as_if_it_were_alone(tmp_path: Path) -> None:
    """The same rules, names of draws, settings, inputs and outputs, job by job."""
    alone, three = jobs_with(tmp_path / "a"), jobs_with(tmp_path / "b", datasets=3)
    first = {tuple(job.outputs.values()): job for job in three}
    for job in alone:
        if job.rule not in OF_ALL:
            same = first[tuple(job.outputs.values())]
            told = (job.rule, job.wildcards, job.parameters, job.inputs)
            assert told == (same.rule, same.wildcards, same.parameters, same.inputs)


def test_every_stage_has_jobs_for_each_data_set(tmp_path: Path) -> None:
    """Also of an experiment that shares the data; figures and clips are of the first."""
    jobs = [job for job in jobs_with(tmp_path / "a", datasets=2) if job.rule not in OF_ALL]
    assert not any(".set3" in path for job in jobs for path in job.outputs.values())
    made = {path for job in jobs for path in job.outputs.values()}
    per_set = {path for path in made if not path.startswith(("figures/", "ratings/", "confusion/"))}
    for name in ("simulator", "again"):
        first = {path for path in per_set if f"/{name}/" in path or f"/{name}_" in path}
        second = {path for path in per_set if f"{name}.set2" in path}
        assert first
        assert {path.replace(name, f"{name}.set2") for path in first} == second
    fit = next(job for job in jobs if job.rule == "fit" and job.wildcards["experiment"] == "again.set2")
    assert fit.parameters["data"] == "simulator.set2"
    assert fit.inputs["trials"] == "features/simulator.set2/D6/train_trials.parquet"
    (collected,) = {job.parameters["experiment"] for job in jobs if "mcap/simulator.set2/train" in str(job.outputs)}
    assert collected == "simulator.set2"


def test_what_is_of_the_whole_study_reads_every_data_set(tmp_path: Path) -> None:
    jobs = {job.rule: set(job.inputs.values()) for job in jobs_with(tmp_path / "a", datasets=2)}
    assert {
        f"scores/simulator{which}_D6_{task}.csv" for which in ("", ".set2") for task in ("csl", "generation")
    } <= jobs["scores"]
    assert {"descriptions/simulator_D6.csv", "descriptions/simulator.set2_D6.csv"} <= jobs["claims"]
    assert {"uncertain/simulator_D6.csv", "uncertain/simulator.set2_D6.csv"} <= jobs["tables"]


def other_messages(log: Log, other: Log) -> list[str]:
    """In which topics two logs differ; what they call themselves does not count."""
    return [line for line in differences(log, other) if not line.startswith("metadata")]


def test_data_sets_differ_in_what_happens_and_not_in_name_alone() -> None:
    """Every trial of the second data set is another one, and so is the calibration; the first is drawn as ever."""
    settings: dict[str, Any] = {"seed": 1, "provenance": {}}
    simulation = Simulation()
    sets = [data_set_name("simulator", dataset) for dataset in (1, 2)]
    assert sets == ["simulator", "simulator.set2"]
    for set_name in ("train", "generation", "description"):
        first, second, again = (
            list(collect(simulation, experiment=name, set_name=set_name, trials=[1, 2], **settings))
            for name in (*sets, sets[0])
        )
        for one, other, same in zip(first, second, again, strict=True):
            assert differences(one, same) == []
            assert any("/truth/" in line for line in other_messages(one, other))
    measured = Simulation.model_validate({"camera": {"mark_error": 0.001}})  # by default the marks are exact
    one, other, same = (calibrate(measured, experiment=name, **settings) for name in (*sets, sets[0]))
    assert differences(one, same) == []
    assert other_messages(one, other)


def test_words_are_omitted_anew_in_each_data_set() -> None:
    draws = [generator(1, "omission", name, 6, 1).random(3) for name in ("simulator", "simulator.set2")]
    assert not np.array_equal(*draws)


def test_a_list_of_logs_is_a_data_set_each(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name / "train").mkdir(parents=True)
        for file in ("calibration", *(f"train/trial_{trial:04}" for trial in range(1, 7))):
            (tmp_path / name / f"{file}.mcap").touch()
    study = plan(minimal(logs=["a", "b"]), tmp_path / FILE)
    assert study.sets("own") == ["own", "own.set2"]
    assert [study.log_folder(name).name for name in study.sets("own")] == ["a", "b"]
    assert list(study.first_sets) == ["own"]


def test_own_features_as_a_list_are_data_sets(tmp_path: Path) -> None:
    """A second pair of files: other fits, a column that tells them apart, and tables over both."""
    pairs = [{kind: f"{kind}{which}.parquet" for kind in ("trials", "objects")} for which in ("", "_more")]
    config = write_own_study(tmp_path, features=pairs, ROW=[0])
    trials, objects = own_rows()
    moved = [row | {"position": (np.asarray(row["position"]) + 0.05).tolist()} for row in objects]
    write_rows(trials, TRIALS_COLUMNS, tmp_path / "trials_more.parquet")
    write_rows(moved, OBJECTS_COLUMNS, tmp_path / "objects_more.parquet")
    out = tmp_path / "out"
    run(config, out)
    scores = pd.read_csv(out / "scores.csv")
    assert scores.groupby("dataset").size().nunique() == 1
    assert sorted(scores["dataset"].unique()) == [1, 2]
    assert set(scores["experiment"]) == {"own"}
    fits = [load(out / f"fits/{name}/default/proposed/published/D20/ROW0/seed1.npz") for name in ("own", "own.set2")]
    assert not np.array_equal(fits[0].trace_log_joint, fits[1].trace_log_joint)
    text = (out / "tables/own_csl.md").read_text()
    assert "over the 2 data sets" in text
    (row,) = pd.read_csv(out / "tables/own_csl.csv").query("method == 'proposed'").to_dict("records")
    means = scores.query("method == 'proposed' and measure == 'EAR'").groupby("dataset")["value"].mean()
    assert (row["EAR_mean"], row["EAR_sd"]) == (round(means.mean(), 6), round(means.std(), 6))
    assert "over the 2 data sets" in (out / "report.html").read_text()
    assert (out / "diagnostics/own.set2_D20.html").is_file()
