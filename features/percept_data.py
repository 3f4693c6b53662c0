"""The result of one pass over the logs, before anything is fitted: detections, crops, fc6, raw actions."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from features.arrays import ArtifactError, load_arrays, save_arrays, texts_from_array, texts_to_array
from features.table import Texts

BY_TRIAL = (
    "trial",
    "acted",
    "attended_object",
    "words",
    "hand",
    "finger_rate",
    "joints",
    "touch",
    "truth_action",
    "truth_attempts",
)
BY_OBJECT = ("position", "box", "crop", "mask", "fc6", "truth_position", "truth_object", "truth_color")
SHARED = ("joint_names", "joint_lower", "joint_upper", "table_height")
OPTIONAL = ("truth_attempts",)  # what only some files have
TRUTH = ("truth_action", "truth_position", "truth_object", "truth_color")


@dataclass(frozen=True, eq=False)
class Percepts:
    """D trials with N objects altogether, as perceived; no number depends on another trial.

    Attributes:
        trial: int64 (D,), ascending.
        acted: bool (D,), whether an action was executed; otherwise hand, joints and touch are those at rest.
        attended_object: int64 (D,), index into the trial's objects, −1 where unknown. Where an action was
            executed it is the detection nearest to the gaze; else the truth, if the log tells it.
        words: D sentences as uttered.
        hand: float64 (D, 3), metres, robot frame.
        finger_rate: float64 (D,), 0 to 1.
        joints: float64 (D, J), radians.
        touch: float64 (D, 9), 0 to 1.
        joint_names: J names.
        joint_lower, joint_upper: float64 (J,), limits in radians.
        table_height: float64 (), z of the table, metres, robot frame.
        trial_index: int64 (N,), row (0..D−1) of each object's trial, ascending; objects from left to right.
        position: float64 (N, 2), metres on the table, robot frame.
        box: int64 (N, 4), left, top, right, bottom in the image before the action, pixels.
        crop: uint8 (N, 64, 64, 3) RGB.
        mask: bool (N, 64, 64), the object in its crop.
        fc6: float32 (N, 4096).
        pixels: uint8 (P, 3), RGB pixels inside the objects' masks, object after object.
        pixel_index: int64 (P,), row (0..N−1) of each pixel's object, ascending.
        dropped: Why each dropped trial was dropped.
        dropped_trial: int64, the numbers of the dropped trials, in the same order.
        truth_action: D words or None, for evaluation only.
        truth_position, truth_object, truth_color: The same, N words.
        truth_attempts: int64 (D,), how often a trial of a fair test set was tried, 0 where unknown; None where it is
            known of no trial.
    """

    trial: NDArray[np.int64]
    acted: NDArray[np.bool_]
    attended_object: NDArray[np.int64]
    words: tuple[tuple[str, ...], ...]
    hand: NDArray[np.float64]
    finger_rate: NDArray[np.float64]
    joints: NDArray[np.float64]
    touch: NDArray[np.float64]
    joint_names: tuple[str, ...]
    joint_lower: NDArray[np.float64]
    joint_upper: NDArray[np.float64]
    table_height: NDArray[np.float64]
    trial_index: NDArray[np.int64]
    position: NDArray[np.float64]
    box: NDArray[np.int64]
    crop: NDArray[np.uint8]
    mask: NDArray[np.bool_]
    fc6: NDArray[np.float32]
    pixels: NDArray[np.uint8]
    pixel_index: NDArray[np.int64]
    dropped: tuple[str, ...] = ()
    dropped_trial: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    truth_action: Texts | None = None
    truth_position: Texts | None = None
    truth_object: Texts | None = None
    truth_color: Texts | None = None
    truth_attempts: NDArray[np.int64] | None = None


def first(percepts: Percepts, D: int) -> Percepts:
    """Return the first D trials by number, with their objects; dropped trials count, but are missing.

    Raises:
        ValueError: D is below 1 or above the number of trials, or all of them were dropped.
    """
    numbers = np.sort(np.concatenate([percepts.trial, percepts.dropped_trial]))
    if not 1 <= D <= len(numbers):
        raise ValueError(f"D is {D}; expected 1 to {len(numbers)}, the number of trials")
    last = numbers[D - 1]
    left = _kept(percepts, percepts.trial <= last, percepts.dropped_trial <= last)
    if not len(left.trial):
        raise ValueError("\n".join([f"none of the first {D} trials is left", *left.dropped]))
    return left


def only(percepts: Percepts, trial: int) -> Percepts:
    """Return one trial with its objects.

    Raises:
        ValueError: There is no such trial, or it was dropped.
    """
    own = percepts.trial == trial
    if not own.any():
        raise ValueError(f"there is no trial {trial}; expected one of {percepts.trial.tolist()}")
    return _kept(percepts, own, np.zeros(len(percepts.dropped), dtype=bool))


def _kept(percepts: Percepts, trials: NDArray[np.bool_], dropped: NDArray[np.bool_]) -> Percepts:
    """The trials (D,) that are marked, with their objects and pixels, and the marked ones of what was dropped."""
    objects = trials[percepts.trial_index]
    pixels = objects[percepts.pixel_index]
    kept: dict[str, Any] = dict.fromkeys(BY_TRIAL, trials) | dict.fromkeys(BY_OBJECT, objects)
    kept |= {"pixels": pixels, "dropped": dropped, "dropped_trial": dropped}
    values = {name: _taken(value, kept[name]) if name in kept else value for name, value in vars(percepts).items()}
    values["trial_index"] = (np.cumsum(trials) - 1)[percepts.trial_index[objects]]
    values["pixel_index"] = (np.cumsum(objects) - 1)[percepts.pixel_index[pixels]]
    return Percepts(**values)


def _taken(values: Any, kept: NDArray[np.bool_]) -> Any:
    """The values that are kept: of an array, a tuple, or truth that is not known."""
    if values is None or isinstance(values, np.ndarray):
        return None if values is None else values[kept]
    return tuple(value for value, stays in zip(values, kept, strict=True) if stays)


def join(parts: Iterable[Percepts]) -> Percepts:
    """Join the trials of several percepts, in order of their numbers.

    Raises:
        ValueError: There are none, a trial occurs twice, the parts interleave, or their joints or tables differ.
    """
    parts = sorted(parts, key=lambda part: int(_numbers(part)[0]))
    if not parts:
        raise ValueError("no trials to join")
    trials = np.concatenate([_numbers(part) for part in parts])
    numbers, counts = np.unique(trials, return_counts=True)
    if np.any(counts > 1):
        raise ValueError(f"trials {numbers[counts > 1].tolist()} occur more than once")
    if np.any(np.diff(trials) < 0):
        raise ValueError("the parts' trials interleave; expected blocks of consecutive trials")
    for name in SHARED:
        for part in parts:
            if not np.array_equal(getattr(part, name), getattr(parts[0], name)):
                raise ValueError(f"trial {_numbers(part)[0]}: {name} differ from those of trial {trials[0]}")
    values: dict[str, Any] = {name: getattr(parts[0], name) for name in SHARED}
    for name in (*BY_TRIAL, *BY_OBJECT, "pixels", "dropped", "dropped_trial"):
        values[name] = _chain(name, parts)
    values["trial_index"] = _shifted([part.trial_index for part in parts], [len(part.trial) for part in parts])
    values["pixel_index"] = _shifted([part.pixel_index for part in parts], [len(part.box) for part in parts])
    return Percepts(**values)


def _numbers(part: Percepts) -> NDArray[np.int64]:
    """The numbers of all trials, ascending: of those that are left and of those that were dropped."""
    return np.sort(np.concatenate([part.trial, part.dropped_trial]))


def _chain(name: str, parts: Sequence[Percepts]) -> Any:
    """Concatenate one field; truth is None when no part has it."""
    values = [getattr(part, name) for part in parts]
    if all(value is None for value in values):
        return None
    counts = [len(part.trial if name in BY_TRIAL else part.box) for part in parts]
    if any(isinstance(value, np.ndarray) for value in values):
        padded = [
            np.zeros(count, dtype=np.int64) if value is None else value
            for value, count in zip(values, counts, strict=True)
        ]
        return np.concatenate(padded)
    padded = [(None,) * count if value is None else value for value, count in zip(values, counts, strict=True)]
    return tuple(item for value in padded for item in value)


def _shifted(indices: Sequence[NDArray[np.int64]], counts: Sequence[int]) -> NDArray[np.int64]:
    """Concatenate indices into parts of `counts` rows, as indices into the whole."""
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    return np.concatenate([index + start for index, start in zip(indices, starts, strict=True)]).astype(np.int64)


def save_percepts(path: Path, percepts: Percepts) -> None:
    """Write percepts as npz; the same percepts give the same bytes."""
    arrays = {name: value for name, value in vars(percepts).items() if name not in OPTIONAL or value is not None}
    arrays["words"] = np.array([json.dumps(sentence, ensure_ascii=False) for sentence in percepts.words])
    for name in ("joint_names", "dropped"):
        arrays[name] = np.array(arrays[name], dtype=np.str_)
    for name in TRUTH:
        arrays[name] = texts_to_array(arrays[name], len(percepts.trial if name in BY_TRIAL else percepts.box))
    save_arrays(path, "percepts", arrays)


def load_percepts(path: Path) -> Percepts:
    """Read what `save_percepts` wrote.

    Raises:
        ArtifactError: The file is missing, damaged or something else.
    """
    names = tuple(item.name for item in fields(Percepts) if item.name not in OPTIONAL)
    arrays: dict[str, Any] = load_arrays(path, "percepts", names, OPTIONAL)
    try:
        arrays["words"] = tuple(tuple(json.loads(str(sentence))) for sentence in arrays["words"])
        for name in ("joint_names", "dropped"):
            arrays[name] = tuple(str(text) for text in arrays[name])
        return Percepts(**arrays | {name: texts_from_array(arrays[name]) for name in TRUTH})
    except (TypeError, ValueError, RecursionError) as error:
        raise ArtifactError(f"{path}: its texts are no percepts' ({error})") from error
