"""Variants of an experiment: the hyperparameters that they change, and the conditions that they are run for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from pydantic import Field, create_model

from data_collection.strict_model import StrictModel
from model.prior import Prior
from workflow.plan.config_types import CHANNELS, Channel, MethodName, Name, Percent, PerChannel, Several, TrialCount

HYPERPARAMETERS = {
    "K": "categories",
    "alpha": "concentration",
    "gamma": "word_concentration",
    "mean_precision": "mean_precision",
    "mean_precision_range": "mean_precision_range",
    "scale": "scale",
    "extra_degrees_of_freedom": "extra_degrees_of_freedom",
}
"""A hyperparameter of the config, and what `model.Prior` calls it."""
BOXES: dict[Channel, tuple[float, float]] = {"position": (-0.5, 0.5)}
"""Where features do not lie in [0, 1]: the interval of each number of a channel."""


class Only(StrictModel):
    """The conditions that a variant is run for; whatever is not named here is run for all."""

    methods: Several[MethodName] = Field(
        (), description="some of the experiment's methods, and gmm, which has no ROW; without gmm, ALL is left out"
    )
    samplers: Several[Name] = Field((), description="some of the experiment's samplers")
    D: Several[TrialCount] = Field((), description="some of the experiment's D")
    ROW: Several[Percent] = Field((), description="some of the experiment's ROW")


class _Variant(StrictModel):
    """Changes of hyperparameters against the paper's, each a number, or one for each channel; and where it is run."""

    only: Only = Only()


if TYPE_CHECKING:
    Variant = _Variant
    Categories: TypeAlias = int | dict[Channel, int]
else:

    def _hyperparameter(key):
        """The type of a hyperparameter of the config, and its field: what `model.Prior` says of it."""
        field = Prior.model_fields[HYPERPARAMETERS[key]]
        number = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
        default = "; by default that of the experiment" if key == "K" else ""
        return PerChannel[number], Field(field.default, description=f"{field.description}{default}")

    Variant = create_model(
        "Variant",
        __base__=_Variant,
        __doc__=_Variant.__doc__,
        **{key: _hyperparameter(key) for key in HYPERPARAMETERS},
    )
    Categories = _hyperparameter("K")[0]


def hyperparameters(changes: Iterable[tuple[str, Any]]) -> dict[Channel, Prior]:
    """The hyperparameters of each channel after changes by the config's keys, of which later ones win.

    Args:
        changes: A key of `HYPERPARAMETERS`, and a number, or one per channel that changes.
    """
    priors: dict[Channel, dict[str, Any]] = {
        channel: {"box": BOXES[channel]} if channel in BOXES else {} for channel in CHANNELS
    }
    for key, value in changes:
        by_channel = value if isinstance(value, dict) else dict.fromkeys(CHANNELS, value)
        for channel, number in by_channel.items():
            priors[channel][HYPERPARAMETERS[key]] = number
    return {channel: Prior(**given) for channel, given in priors.items()}
