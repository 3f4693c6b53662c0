"""The settings of an experiment as a reader wants them: complete, and without paths of one machine."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from workflow.plan.config_types import CHANNELS
from workflow.plan.experiment import Experiment
from workflow.plan.variants import HYPERPARAMETERS

SOURCES = {"simulation": "simulated trials", "logs": "a robot's logs", "features": "feature tables"}


def source_in_words(experiment: Experiment) -> str:
    """Where the data of an experiment come from."""
    return SOURCES[experiment.source] if experiment.data == experiment.name else f"those of {experiment.data}"


def all_settings(experiment: Experiment) -> dict[str, Any]:
    """Every setting of an experiment, the defaults of what the config leaves open included, as plain data.

    An absolute path is but the name of its file.
    """
    own = experiment.data == experiment.name
    unused = {"K"}  # which every variant has
    if not own or experiment.source != "simulation":
        unused.add("simulation")
    if not own or experiment.source == "features":
        unused.add("feature_extraction")
    settings = experiment.settings.model_dump(mode="json", exclude=unused, exclude_none=True)
    settings["words"] = experiment.words
    settings["figure"] = experiment.settings.figure.model_dump(exclude_unset=True)
    settings["variants"] = {
        name: _hyperparameters(experiment, name)
        | variant.model_dump(mode="json", include={"only"}, exclude_unset=True)
        for name, variant in experiment.settings.variants.items()
    }
    plain: dict[str, Any] = _without_folders(settings)
    return plain


def _hyperparameters(experiment: Experiment, variant: str) -> dict[str, Any]:
    """By the config's name: one number where it is the same for all channels, or one per channel."""
    priors = experiment.priors(variant)
    result: dict[str, Any] = {}
    for key, name in HYPERPARAMETERS.items():
        values = {channel: getattr(priors[channel], name) for channel in CHANNELS}
        result[key] = values["action"] if len(set(values.values())) == 1 else values
    return result


def _without_folders(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_folders(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_without_folders(inner) for inner in value]
    return PurePath(value).name if isinstance(value, str) and PurePath(value).is_absolute() else value
