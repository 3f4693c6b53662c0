"""From a config file to the plan of a study."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from workflow.plan.checks import contradictions, data_problems, grid_problems
from workflow.plan.config import ConfigError, read_config
from workflow.plan.problems import key_path, problems_of
from workflow.plan.study import Experiment, Study
from workflow.plan.study_config import StudyConfig, completed

MAX_FITS = 100_000
"""Fits, and jobs that simulate, of one experiment."""


def load_study(path: Path) -> Study:
    """Read, check and complete a config file.

    Raises:
        ConfigError: with everything that is wrong.
    """
    return plan(read_config(path), path)


def plan(config: Mapping[str, Any], path: Path) -> Study:
    """Check a config and fill in its defaults.

    Args:
        config: plain data.
        path: the file that it came from.

    Raises:
        ConfigError: with everything that is wrong.
    """
    try:
        checked = StudyConfig.model_validate(config)
    except ValidationError as error:
        raise ConfigError(str(path), problems_of(error, config)) from None
    _stop(path, [problem for name in checked.experiments for problem in contradictions(name, checked)])
    study = Study({name: _experiment(name, checked) for name in checked.experiments}, path.parent)
    tells = "{}: asks for {:,} fits and parts of a simulation; at most {:,} are run (fewer seeds, D or variants)"
    _stop(
        path,
        [
            tells.format(key_path(["experiments", name]), count, MAX_FITS)
            for name in study.experiments
            if (count := study.size(name)) > MAX_FITS
        ],
    )
    _stop(
        path,
        [
            problem
            for name in study.experiments
            for problem in (*grid_problems(study, name), *data_problems(study, name))
        ],
    )
    return study


def _stop(path: Path, problems: list[str]) -> None:
    if problems:
        raise ConfigError(str(path), problems)


def _experiment(name: str, config: StudyConfig) -> Experiment:
    settings = completed(config, name)
    data = settings.data or name
    words = settings.words or config.experiments[data].words
    return Experiment(name, data, {channel: list(said) for channel, said in words or ()}, settings)
