"""The settings of an experiment as a reader wants them: complete, and without paths of one machine."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import PurePath
from typing import Any

from data_collection.settings import Simulation
from features.settings import FeatureSettings
from workflow.plan.study import HYPERPARAMETERS, Experiment

ORIGINS = {"simulation": "simulated trials", "logs": "a robot's logs", "features": "feature tables"}


def origin(experiment: Experiment) -> str:
    """Where the data of an experiment come from, in words."""
    return ORIGINS[experiment.source] if experiment.data == experiment.name else f"those of {experiment.data}"


def portable(experiment: Experiment) -> Experiment:
    """The same experiment in which an absolute path is but the name of its file."""
    return replace(experiment, settings=_without_folders(experiment.settings))


def _without_folders(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_folders(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_without_folders(inner) for inner in value]
    return PurePath(value).name if isinstance(value, str) and PurePath(value).is_absolute() else value


def complete(experiment: Experiment) -> dict[str, Any]:
    """Every setting of an experiment, the defaults of what the config leaves open included, as plain data."""
    settings = dict(experiment.settings)
    settings["variants"] = {variant: _hyperparameters(experiment.priors(variant)) for variant in settings["variants"]}
    del settings["K"]  # in every variant
    if experiment.data == experiment.name:
        if experiment.source == "simulation":
            settings["simulation"] = asdict(Simulation.from_mapping(settings.get("simulation", {})))
        if experiment.source != "features":
            settings["feature_extraction"] = asdict(
                FeatureSettings.from_mapping(settings.get("feature_extraction", {}))
            )
    plain: dict[str, Any] = json.loads(json.dumps(settings))  # tuples become lists
    return plain


def _hyperparameters(priors: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """By the config's name: one number where it is the same for all channels, or one a channel."""
    from model import Prior

    complete = {channel: Prior(**given) for channel, given in priors.items()}
    result: dict[str, Any] = {}
    for key, name in HYPERPARAMETERS.items():
        values = {channel: getattr(prior, name) for channel, prior in complete.items()}
        result[key] = next(iter(values.values())) if len(set(values.values())) == 1 else values
    return result
