"""From a config file to the plan of a study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workflow.plan.checks import contradictions, data_problems, grid_problems
from workflow.plan.config import ConfigError, default, key_path, read_config, schema_problems
from workflow.plan.limits import MAX_FITS
from workflow.plan.study import SHARED_KEYS, Experiment, Study


def load_study(path: Path) -> Study:
    """Read, check and complete a config file.

    Raises:
        ConfigError: with everything that is wrong.
    """
    return plan(read_config(path), path)


def plan(config: Mapping[str, Any], path: Path) -> Study:
    """Check a config and fill in its defaults; `path` is the file that it came from.

    Raises:
        ConfigError: with everything that is wrong.
    """
    problems = schema_problems(config)
    if problems:
        raise ConfigError(str(path), problems)
    experiments = {name: _complete(name, config) for name in config["experiments"]}
    problems = [problem for name in experiments for problem in contradictions(name, config)]
    if problems:
        raise ConfigError(str(path), problems)
    study = Study(experiments, path.parent)
    if jobs := {name: count for name in experiments if (count := study.size(name)) > MAX_FITS}:
        tells = "{}: asks for {:,} fits and parts of a simulation; at most {:,} are run (fewer seeds, D or variants)"
        raise ConfigError(
            str(path),
            [tells.format(key_path(["experiments", name]), count, MAX_FITS) for name, count in jobs.items()],
        )
    problems = [
        problem for name in experiments for problem in (*grid_problems(study, name), *data_problems(study, name))
    ]
    if problems:
        raise ConfigError(str(path), problems)
    return study


def _complete(name: str, config: Mapping[str, Any]) -> Experiment:
    own = config["experiments"][name]
    shared = {key: config[key] for key in SHARED_KEYS if key in config}
    optional = (*SHARED_KEYS, "ROW", "seeds", "K", "variants", "trials_per_job", "figure")
    settings = {key: default(key) for key in optional} | shared | own
    largest, fullest = [max(own["D"])], [min(settings["ROW"])]
    settings["generation"] = {"sentences": 12, "D": largest, "ROW": fullest, "rated": 1} | own.get("generation", {})
    settings["description"] = {"actions": 12, "D": own["D"], "ROW": settings["ROW"]} | own.get("description", {})
    owner = config["experiments"].get(own.get("data"), {})
    if "words" not in own and "words" in owner:
        settings["words"] = owner["words"]
    source = next((kind for kind in ("features", "logs") if kind in own), "simulation")
    return Experiment(name, source, own.get("data", name), settings)
