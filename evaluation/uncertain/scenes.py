"""The objects on the table that an uncertain instruction speaks of, and the same table with one object twice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evaluation.generation import objects_of
from evaluation.scores import Words
from features.table import FeatureTable
from model.data import Floats

OBJECT_CHANNELS = ("position", "object", "color")


@dataclass(frozen=True, eq=False)
class Scene:
    """The objects on a table.

    Attributes:
        trial: The number of the trial whose scene it is.
        features: (M, dim) of the M objects, by channel.
        truth: The true words of the M objects, by channel; None where one is not known.
        instructed: Index of the instructed object; None where it is not known.
    """

    trial: int
    features: Mapping[str, Floats]
    truth: Mapping[str, tuple[str | None, ...]]
    instructed: int | None


def scene_of(table: FeatureTable, row: int) -> Scene:
    """The objects on the table in a row's trial."""
    own = np.flatnonzero(table.trial_index == row)
    truth = {
        channel: getattr(table, f"truth_{channel}") or (None,) * len(table.position) for channel in OBJECT_CHANNELS
    }
    instructed = int(table.attended_object[row])
    return Scene(
        trial=int(table.trial[row]),
        features=objects_of(table, row),
        truth={channel: tuple(known[i] for i in own) for channel, known in truth.items()},
        instructed=None if instructed < 0 else instructed,
    )


def places_of(table: FeatureTable, words: Words) -> dict[str, Floats]:
    """The position of the table's first object at each place, in the order of the position words."""
    known = table.truth_position or ()
    return {place: table.position[known.index(place)] for place in words["position"] if place in known}


def with_twin(scene: Scene, places: Mapping[str, Floats]) -> Scene | None:
    """The scene with the instructed object a second time, at the first place where no object is."""
    free = next((place for place in places if place not in scene.truth["position"]), None)
    if scene.instructed is None or free is None or None in scene.truth["position"]:
        return None
    one = scene.instructed
    features = {channel: np.concatenate([rows, rows[one : one + 1]]) for channel, rows in scene.features.items()}
    features["position"][-1] = places[free]
    truth = {channel: (*known, known[one]) for channel, known in scene.truth.items()}
    return Scene(scene.trial, features, {**truth, "position": (*scene.truth["position"], free)}, one)
