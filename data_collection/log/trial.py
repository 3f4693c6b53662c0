"""What one log says, as typed views; features never touch topics."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from data_collection.limits import normal
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError
from data_collection.log.messages import CameraInfo, Floats, Image, JointState
from data_collection.log.numbering import number_of
from data_collection.log.topics import LogKind
from data_collection.log.validation import kind_of, problems, told


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
        trial=number_of(log.source, log.metadata) or 0,  # which was checked
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
        words=tuple(normal(last[topics.SENTENCE]).split()),
    )


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
    if found := problems(log, kind):
        raise LogError(told(found))
    return {message.topic: message.value for message in log.messages}
