"""Features whose numbers are far from what the prior expects: most often another unit than the model's."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from workflow.plan.config_types import Channel
from workflow.plan.experiment import Experiment
from workflow.plan.study import Study

COLUMNS: Mapping[Channel, tuple[str, str]] = {
    "action": ("trials", "action"),
    "position": ("objects", "position"),
    "object": ("objects", "object_feature"),
}
"""The file and the column of each channel; a color is shares, which have no unit."""
TOO_WIDE, TOO_NARROW, TOO_FAR = 10.0, 0.05, 20.0
"""Standard deviations of all trials, and the mean's distance from m0, in spreads that the prior expects."""


def unlikely_units(study: Study, owner: Experiment, table: Any, paths: Mapping[str, Path]) -> Iterator[str]:
    """A line for each channel whose numbers no variant of the experiments that use a table expects.

    Categories of the prior spread by √scale about their means. Numbers that all together spread less than a twentieth
    of this are one category to the model; numbers that spread ten times as much, or lie twenty times as far from 0,
    are further apart than its categories reach.
    """
    users = study.users(owner.name)
    for channel, (file, column) in COLUMNS.items():
        values = getattr(table, column)
        spread = float(np.max(values.std(axis=0), initial=0.0))
        centre = float(np.max(np.abs(values.mean(axis=0)), initial=0.0))
        scales = [user.priors(variant)[channel].scale for user in users for variant in user.settings.variants]
        expected = [math.sqrt(scale) for scale in scales]
        if all(spread > TOO_WIDE * one or centre > TOO_FAR * one for one in expected):
            told = f"spread by {spread:.3g} about {centre:.3g}"
        elif len(values) > 1 and all(spread < TOO_NARROW * one for one in expected):
            told = f"spread by {spread:.3g} in all"
        else:
            continue
        yield (
            f"{paths[file]}: column {column!r}: the numbers {told}, but the prior of channel {channel} expects "
            f"categories that spread by {expected[0]:.3g}{_hint(channel, spread)}; scale them, or set `scale`"
        )


def _hint(channel: Channel, spread: float) -> str:
    if channel != "position":
        return " within about 0 to 1"
    guess = "millimetres or pixels" if spread > 30 else "centimetres" if spread > 1 else "in another unit or frame"
    return f"; metres in the robot's frame are expected, these may be {guess}"
