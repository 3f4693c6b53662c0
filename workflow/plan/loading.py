"""From a config file to the plan of a study."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from evaluation.data_sets import data_set_name
from workflow.plan.checks import contradictions, data_problems, grid_problems, size_problems
from workflow.plan.config import ConfigError, read_config
from workflow.plan.experiment import Experiment
from workflow.plan.problems import problems_of
from workflow.plan.study import Study
from workflow.plan.study_config import StudyConfig, completed, count_of_sets

log = logging.getLogger(__name__)


def load_study(path: Path) -> Study:
    """Read, check and complete a config file; what stands out without forbidding anything is a warning.

    Raises:
        ConfigError: With everything that is wrong.
    """
    study = plan(read_config(path), path)
    for note in study.notes:
        log.warning("note: %s", note)
    return study


def plan(config: Mapping[str, Any], path: Path) -> Study:
    """Check a config and fill in its defaults.

    Args:
        config: Plain data.
        path: The file that it came from.

    Raises:
        ConfigError: With everything that is wrong.
    """
    try:
        checked = StudyConfig.model_validate(config)
    except ValidationError as error:
        raise ConfigError(str(path), problems_of(error, config)) from None
    names = list(checked.experiments)
    _stop(path, (problem for name in names for problem in contradictions(name, checked)))
    sets = [_experiment(name, checked, one) for name in names for one in range(1, count_of_sets(checked, name) + 1)]
    study = Study({own.name: own for own in sets}, path.parent)
    _stop(path, (problem for name in names for problem in size_problems(study, name)))
    _stop(path, (one for name in names for one in grid_problems(study, name)))
    notes: list[str] = []
    _stop(path, (one for own in sets for one in data_problems(study, own.name, notes)))
    return replace(study, notes=tuple(dict.fromkeys(notes)))


def _stop(path: Path, problems: Iterable[str]) -> None:
    if found := list(problems):
        raise ConfigError(str(path), found)


def _experiment(name: str, config: StudyConfig, dataset: int) -> Experiment:
    settings = completed(config, name)
    data = settings.data or name
    words = settings.words or config.experiments[data].words
    own, used = (data_set_name(one, dataset) for one in (name, data))
    return Experiment(own, used, {channel: list(said) for channel, said in words or ()}, settings, dataset)
