"""What the report says of settings and versions: complete, and the same on every machine."""

from __future__ import annotations

import json
from pathlib import Path

import yaml

from model import Prior
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.versions import pinned_packages, python_version, study_hash
from workflow.plan.all_settings import all_settings, source_in_words
from workflow.plan.loading import load_study, plan

STUDY = ROOT / "config" / "config.yaml"


def test_defaults_are_filled_in_and_what_is_said_wins() -> None:
    settings = all_settings(load_study(STUDY).experiments["real"])
    said = yaml.safe_load(STUDY.read_text(encoding="utf-8"))["experiments"]["real"]
    assert settings["simulation"]["camera"]["noise"] == said["simulation"]["camera"]["noise"]
    assert settings["simulation"]["camera"]["view"] == 64.0
    assert settings["feature_extraction"]["components"] == said["feature_extraction"]["components"]
    assert settings["feature_extraction"]["weights"] == "seeded"
    assert settings["variants"]["default"]["K"] == said["K"]
    assert settings["variants"]["default"]["gamma"] == Prior().word_concentration


def test_a_hyperparameter_of_one_channel_is_told_by_channel() -> None:
    config = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    config["experiments"]["simulator"]["variants"] = {"narrow": {"scale": {"position": 0.5}}}
    config["experiments"]["shared"] = {"D": [6], "data": "simulator"}
    experiments = plan(config, STUDY).experiments
    told = all_settings(experiments["simulator"])["variants"]["narrow"]
    assert told["scale"] == {"action": 0.01, "position": 0.5, "object": 0.01, "color": 0.01}
    assert told["alpha"] == 1.0
    assert [source_in_words(experiments[name]) for name in ("simulator", "shared")] == [
        "simulated trials",
        "those of simulator",
    ]
    assert "simulation" not in all_settings(experiments["shared"])


def test_absolute_paths_are_told_by_name(tmp_path: Path) -> None:
    weights = tmp_path / "alexnet.pt"
    weights.touch()
    config = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    config["experiments"]["real"]["feature_extraction"] = {"weights": str(weights)}
    told = all_settings(plan(config, STUDY).experiments["real"])
    assert told["feature_extraction"]["weights"] == "alexnet.pt"
    assert str(tmp_path) not in json.dumps(told)


def test_versions_are_those_of_the_lock_file() -> None:
    packages = pinned_packages()
    lock = (ROOT / "environment.lock").read_text(encoding="utf-8").splitlines()
    assert all(f"{name}=={version}" in lock for name, version in packages.items())
    assert {"numpy", "pybullet", "snakemake", "opencv-python-headless"} <= set(packages)
    assert "pytest" not in packages
    assert python_version() == "3.11"
    assert len(study_hash()) == 64
