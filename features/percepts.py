"""One pass over the logs of an experiment: see the objects, feel the body, hear the words."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.joints import JOINT_NAMES, TACTILE_NAMES
from data_collection.log.mcap_log import Log, LogError
from data_collection.log.numbering import order_problems
from data_collection.log.trial import Observation, calibration, observation
from data_collection.log.truth import Truth, truth
from features.detection import CROP_SIZE, Found, crop, detect, without_rim
from features.extraction_settings import Detection, FeatureSettings
from features.object_feature import FC6_SIZE, fc6
from features.percept_data import Percepts, join
from features.position import standing_position
from features.threads import one_thread
from features.view import View, fit_view

log = logging.getLogger(__name__)

MATCH_DISTANCE = 0.05
"""A detection farther than this from every true object, metres, has no truth."""


# What the trials of a block hold of which none is left.
_NO_TRIAL: dict[str, Any] = {
    "trial": np.zeros(0, dtype=np.int64),
    "acted": np.zeros(0, dtype=np.bool_),
    "attended_object": np.zeros(0, dtype=np.int64),
    "words": (),
    "hand": np.zeros((0, 3)),
    "finger_rate": np.zeros(0),
    "joints": np.zeros((0, len(JOINT_NAMES))),
    "touch": np.zeros((0, len(TACTILE_NAMES))),
    "trial_index": np.zeros(0, dtype=np.int64),
    "position": np.zeros((0, 2)),
    "box": np.zeros((0, 4), dtype=np.int64),
    "crop": np.zeros((0, CROP_SIZE, CROP_SIZE, 3), dtype=np.uint8),
    "mask": np.zeros((0, CROP_SIZE, CROP_SIZE), dtype=np.bool_),
    "fc6": np.zeros((0, FC6_SIZE), dtype=np.float32),
    "pixels": np.zeros((0, 3), dtype=np.uint8),
    "pixel_index": np.zeros(0, dtype=np.int64),
}


class DetectionError(ValueError):
    """A trial shows an implausible number of objects; the message names it."""


def perceive(logs: Iterable[Log], calibration_log: Log, settings: FeatureSettings) -> Percepts:
    """See, feel and hear what the logs hold.

    Args:
        logs: One log per trial, of one experiment and set, in any order.
        calibration_log: The calibration log of the same experiment.
        settings: Settings of detection, crops and network.

    Raises:
        DetectionError: A trial shows an implausible number of objects and the settings do not drop it.
        LogError: A log lacks a signal or holds a bad one, or says another trial's number.
        ValueError: The trials' joints or images differ, or there are none.
    """
    with one_thread():
        view = fit_view(calibration(calibration_log))
        parts: list[Percepts] = []
        sources: list[tuple[str, int]] = []
        for one in logs:
            seen = observation(one)
            sources.append((one.source, seen.trial))
            found = found_objects(seen, view, settings.detection)
            if problem := wrong_count(seen.trial, len(found), settings.detection):
                if settings.detection.on_wrong_count == "error":
                    raise DetectionError(f"{one.source}: {problem}")
                log.warning("dropped: %s", problem)
                parts.append(_dropped(seen, problem, view))
            else:
                parts.append(_perceive_trial(seen, truth(one), found, view, settings))
        if problems := list(order_problems(sources)):
            raise LogError("\n".join(problems))
        joined = join(parts)
        return replace(joined, fc6=fc6(joined.crop, joined.mask, settings))


def found_objects(seen: Observation, view: View, settings: Detection) -> tuple[Found, ...]:
    """Return the objects of a trial.

    Raises:
        ValueError: The picture has another size than that of the calibration.
    """
    try:
        return detect(seen.image_before, view.empty, settings)
    except ValueError as error:
        raise ValueError(f"trial {seen.trial}: {error}") from error


def wrong_count(trial: int, count: int, settings: Detection) -> str:
    """Say what is implausible about a number of objects; empty if nothing is."""
    fewest, most = settings.fewest_objects, settings.most_objects
    if fewest <= count <= most:
        return ""
    return f"trial {trial}: {count} objects found; expected {fewest} to {most} (feature_extraction.detection)"


def _dropped(seen: Observation, problem: str, view: View) -> Percepts:
    """Return the percepts of a trial of which nothing is kept but why."""
    return Percepts(
        **_NO_TRIAL,
        joint_names=tuple(seen.joint_names),
        joint_lower=seen.joint_lower,
        joint_upper=seen.joint_upper,
        table_height=np.array(view.table_height),
        dropped=(problem,),
        dropped_trial=np.array([seen.trial]),
    )


def _perceive_trial(
    seen: Observation, true: Truth | None, found: tuple[Found, ...], view: View, settings: FeatureSettings
) -> Percepts:
    """Return the percepts of one trial, with fc6 still to come."""
    image = seen.image_before
    inner = [without_rim(one, settings.mask_edge) for one in found]
    crops, masks = zip(*(crop(image, one, settings.crop_margin) for one in inner), strict=True)
    pixels = [image[one.mask] for one in inner]
    position = np.stack([standing_position(one.mask, view.camera) for one in found])
    match = _match(position, true)
    attended = _attended(seen, position, match, true)
    truths: dict[str, Any] = {}
    if true is not None:
        said = {"position": true.place_words, "object": true.object_words, "color": true.color_words}
        for channel, words in said.items():
            truths[f"truth_{channel}"] = tuple(words[i] if i >= 0 else None for i in match)
        truths["truth_action"] = (true.action_word or None,)
    return Percepts(
        trial=np.array([seen.trial]),
        attended_object=np.array([attended]),
        words=(tuple(seen.words),),
        **_body(seen),
        joint_names=tuple(seen.joint_names),
        joint_lower=seen.joint_lower,
        joint_upper=seen.joint_upper,
        table_height=np.array(view.table_height),
        trial_index=np.zeros(len(found), dtype=np.int64),
        position=position,
        box=np.array([one.box for one in found]),
        crop=np.stack(crops),
        mask=np.stack(masks),
        fc6=np.zeros((len(found), FC6_SIZE), dtype=np.float32),
        pixels=np.concatenate(pixels),
        pixel_index=np.repeat(np.arange(len(found)), [len(part) for part in pixels]),
        **truths,
        truth_attempts=None if true is None or true.attempts is None else np.array([true.attempts]),
    )


def _body(seen: Observation) -> dict[str, Any]:
    """Return what a trial's percepts say of the robot's body."""
    acted = seen.gaze_target is not None
    return {
        "acted": np.array([acted]),
        "hand": seen.hand_position[None],
        "finger_rate": np.array([seen.finger_rate if acted else 0.0]),
        "joints": seen.joint_positions[None],
        "touch": seen.tactile[None],
    }


def with_action(scene: Percepts, seen: Observation) -> Percepts:
    """Return the percepts of an action in a scene whose objects the robot has already seen.

    Args:
        scene: One trial, before the action.
        seen: What the robot felt when the action was over.

    Raises:
        ValueError: No action was executed.
    """
    if seen.gaze_target is None:
        raise ValueError(f"trial {seen.trial}: no action was executed")
    attended = _attended(seen, scene.position, np.zeros(0, dtype=np.int64), None)
    return replace(scene, attended_object=np.array([attended]), **_body(seen))


def _match(position: NDArray[np.float64], true: Truth | None) -> NDArray[np.int64]:
    """Return the true object (N,) of each detection, matched by distance; −1 for none."""
    from scipy.optimize import linear_sum_assignment

    match = np.full(len(position), -1)
    if true is not None and len(true.positions):
        distance = np.linalg.norm(position[:, None] - true.positions[None], axis=2)
        rows, columns = linear_sum_assignment(distance)
        near = distance[rows, columns] <= MATCH_DISTANCE
        match[rows[near]] = columns[near]
    return match


def _attended(seen: Observation, position: NDArray[np.float64], match: NDArray[np.int64], true: Truth | None) -> int:
    """Return the detection that the robot looks at, or the true one if it does not look; −1 for none."""
    if seen.gaze_target is not None:
        return int(np.linalg.norm(position - seen.gaze_target, axis=1).argmin())
    rows = np.flatnonzero(match == true.attended) if true is not None else np.zeros(0)
    return int(rows[0]) if len(rows) else -1
