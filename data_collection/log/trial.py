"""What one log says, as typed views; features never touch topics."""

import json
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from data_collection.limits import WORD_RULE, is_word
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError
from data_collection.log.messages import CameraInfo, Floats, Image, JointState
from data_collection.log.topics import LogKind
from data_collection.log.validation import kind_of, problems


@dataclass(frozen=True)
class Observation:
    """What the robot itself perceives, does and hears in a trial. Nothing here is made from a truth topic.

    Attributes:
        trial: Number from 1.
        image_before: (H, W, 3) uint8 RGB, rest posture, before the action.
        image_gaze: Likewise while looking at the object; None in an instruction, where nothing was done yet.
        image_after: Likewise when the action is over; None in an instruction.
        camera: Intrinsics as the robot knows them.
        joint_names: The 25 names: head 6, right arm 16 (7 of the arm, 9 of the hand), torso 3.
        joint_positions: (25,) radians at the end of the action.
        joint_lower: (25,) lower limits, radians.
        joint_upper: (25,) upper limits, radians.
        tactile: (9,) in 0..1 at the end of the action: five fingertips, four palm patches.
        hand_position: (3,) of the grasp point, metres, robot frame, at the end of the action.
        finger_rate: Commanded bend of the fingers, 0 open .. 1 closed; 0 in an instruction.
        gaze_target: (2,) commanded fixation point, metres ahead and left; None in an instruction.
        words: The sentence as uttered, may be empty.
    """

    trial: int
    image_before: Image
    image_gaze: Image | None
    image_after: Image | None
    camera: CameraInfo
    joint_names: tuple[str, ...]
    joint_positions: Floats
    joint_lower: Floats
    joint_upper: Floats
    tactile: Floats
    hand_position: Floats
    finger_rate: float
    gaze_target: Floats | None
    words: tuple[str, ...]


@dataclass(frozen=True)
class Truth:
    """What the simulator, or whoever annotated the log, knows; for evaluation only.

    Attributes:
        object_words: Word of the object channel of each of the M objects.
        color_words: Word of the color channel of each.
        place_words: Word of the position channel of each.
        positions: (M, 2) metres ahead and left, before the action.
        attended: Index of the object that was acted on, or that the instruction means.
        action_word: Word for what happened, or what the instruction demands.
        outcome: What physically happened: `action`, `contact`, `held`, `rise`, `hand_error`, `toppled`;
            in an instruction only `action` and `word`.
    """

    object_words: tuple[str, ...]
    color_words: tuple[str, ...]
    place_words: tuple[str, ...]
    positions: Floats
    attended: int
    action_word: str
    outcome: Mapping[str, Any]


@dataclass(frozen=True)
class Calibration:
    """How the camera sees the table.

    Attributes:
        image_empty: (H, W, 3) uint8 RGB, the empty table from the rest posture.
        image_marks: Likewise with dark dots on it.
        mark_positions: (N, 2) measured centres of the dots, metres ahead and left, N = rows · columns: rows
            from far (top of the image) to near, each from left to right as seen in the image.
        mark_rows: Rows of the grid.
        mark_columns: Dots in a row.
        table_height: Height of the table in the robot frame, metres.
        camera: Intrinsics as the robot knows them.
    """

    image_empty: Image
    image_marks: Image
    mark_positions: Floats
    mark_rows: int
    mark_columns: int
    table_height: float
    camera: CameraInfo


def observation(log: Log) -> Observation:
    """Return what the robot perceives in a log of a trial or of an instruction.

    Raises:
        LogError: Lists every missing topic and every bad value.
    """
    kind = kind_of(log)
    last = _last(log, kind)
    if kind == "calibration":
        raise LogError(f"{log.source}: this is a calibration log, not one of a trial")
    joints: JointState = last[topics.JOINT_STATES]
    gaze = last.get(topics.GAZE_TARGET)
    return Observation(
        trial=int(log.metadata["trial"]),
        image_before=last[topics.IMAGE_BEFORE],
        image_gaze=last.get(topics.IMAGE_GAZE),
        image_after=last.get(topics.IMAGE_AFTER),
        camera=last[topics.CAMERA],
        joint_names=joints.names,
        joint_positions=joints.position,
        joint_lower=last[topics.JOINT_LOWER].position,
        joint_upper=last[topics.JOINT_UPPER].position,
        tactile=last[topics.TACTILE],
        hand_position=last[topics.HAND_POSE][:3],
        finger_rate=float(last.get(topics.FINGER_RATE, 0.0)),
        gaze_target=None if gaze is None else gaze[:2],
        words=tuple(last[topics.SENTENCE].split()),
    )


def truth(log: Log) -> Truth | None:
    """Return the truth of a log, or None when it has no truth topics.

    Raises:
        LogError: The truth is not as documented, or only some of it is there. Other topics are not looked at.
    """
    last = {message.topic: message.value for message in log.messages}
    scene, outcome = last.get(topics.TRUTH_SCENE), last.get(topics.TRUTH_OUTCOME)
    if scene is None and outcome is None:
        return None
    if not isinstance(scene, str) or not isinstance(outcome, str):
        missing = topics.TRUTH_OUTCOME if outcome is None else topics.TRUTH_SCENE
        raise LogError(f"{log.source}: {missing} is missing while other truth is there")
    try:
        known, happened = json.loads(scene), json.loads(outcome)
        objects = known["objects"]
        result = Truth(
            object_words=tuple(_word(item["object"]) for item in objects),
            color_words=tuple(_word(item["color"]) for item in objects),
            place_words=tuple(_word(item["place"]) for item in objects),
            positions=np.array([item["position"] for item in objects], dtype=np.float64).reshape(-1, 2),
            attended=operator.index(known["attended"]),
            action_word=_word(happened["word"]),
            outcome=happened,
        )
        if not np.isfinite(result.positions).all():
            raise ValueError("a position is not finite")
        if not 0 <= result.attended < len(objects):
            raise ValueError(f"attended is {result.attended}, there are {len(objects)} objects")
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise LogError(
            f"{log.source}: {topics.TRUTH_SCENE} or {topics.TRUTH_OUTCOME} is not as documented "
            f"({type(error).__name__}: {error})"
        ) from error
    return result


def _word(value: Any) -> str:
    """Return a word; raises ValueError when it is none."""
    if not (isinstance(value, str) and is_word(value)):
        raise ValueError(f"{str(value)[:60]!r} is no word ({WORD_RULE})")
    return value


def calibration(log: Log) -> Calibration:
    """Return the content of a calibration log.

    Raises:
        LogError: Lists every missing topic and every bad value, also when the log is one of a trial.
    """
    last = _last(log, "calibration")
    poses = last[topics.CALIBRATION_POSITIONS]
    pattern = json.loads(last[topics.CALIBRATION_PATTERN])
    return Calibration(
        image_empty=last[topics.CALIBRATION_EMPTY],
        image_marks=last[topics.CALIBRATION_MARKS],
        mark_positions=poses[:, :2],
        mark_rows=int(pattern["rows"]),
        mark_columns=int(pattern["columns"]),
        table_height=float(np.median(poses[:, 2])),
        camera=last[topics.CAMERA],
    )


def _last(log: Log, kind: LogKind) -> dict[str, Any]:
    """Return the last value on each topic, after the whole log was checked."""
    found = problems(log, kind)
    if found:
        raise LogError("\n".join(found))
    return {message.topic: message.value for message in log.messages}
