"""The one table of signals: what a log of a trial, or of a calibration, holds.

Writer, reader, validator and documentation derive from ``CHANNELS``.
"""

from dataclasses import dataclass
from typing import Literal

LogKind = Literal["trial", "instruction", "calibration"]
"""``trial``: an action was executed. ``instruction``: scene and sentence only (set ``generation``)."""

ROOT_FRAME = "root_link"
"""Robot frame: origin at the robot's root, x ahead, y left, z up, metres."""
CAMERA_FRAME = "left_eye_optical"
TRUTH_PREFIX = "/truth/"

HEAD_JOINTS = ("neck_pitch", "neck_roll", "neck_yaw", "eyes_tilt", "eyes_version", "eyes_vergence")
ARM_JOINTS = (
    "r_shoulder_pitch",
    "r_shoulder_roll",
    "r_shoulder_yaw",
    "r_elbow",
    "r_wrist_prosup",
    "r_wrist_pitch",
    "r_wrist_yaw",
)
HAND_JOINTS = (
    "r_hand_finger",
    "r_thumb_oppose",
    "r_thumb_proximal",
    "r_thumb_distal",
    "r_index_proximal",
    "r_index_distal",
    "r_middle_proximal",
    "r_middle_distal",
    "r_pinky",
)
TORSO_JOINTS = ("torso_pitch", "torso_roll", "torso_yaw")
JOINT_NAMES = HEAD_JOINTS + ARM_JOINTS + HAND_JOINTS + TORSO_JOINTS
"""The 25 joints in the order of logs and features: head 6, right arm 7, right hand 9, torso 3."""

TACTILE_NAMES = (
    "thumb_tip",
    "index_tip",
    "middle_tip",
    "ring_tip",
    "little_tip",
    "palm_index_front",
    "palm_little_front",
    "palm_index_back",
    "palm_little_back",
)
"""The 9 touch sensors: five fingertips, four patches of the palm (side of index or little finger, front or back)."""


@dataclass(frozen=True)
class Channel:
    """One signal.

    Attributes:
        topic: ROS topic.
        type: ROS 2 message type.
        shape: Shape of the decoded value as text; letters are free sizes.
        unit: Unit and, where it has one, range of the values.
        frame: Frame that the values refer to, empty where there is none.
        required: Kinds of log that must have it.
        optional: Kinds of log that may have it.
        meaning: What it is, and how often.
        length: Exact number of values where it is fixed, else None.
        lowest: Smallest value allowed, or None.
        highest: Largest value allowed, or None; likewise of the positions of joints.
        once: Whether it may come only once in a log.
    """

    topic: str
    type: str
    shape: str
    unit: str
    frame: str
    required: tuple[LogKind, ...]
    optional: tuple[LogKind, ...]
    meaning: str
    length: int | None = None
    lowest: float | None = None
    highest: float | None = None
    once: bool = False


IMAGE = "sensor_msgs/msg/CompressedImage"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
JOINT_STATE = "sensor_msgs/msg/JointState"
POSE = "geometry_msgs/msg/PoseStamped"
POSES = "geometry_msgs/msg/PoseArray"
POINT = "geometry_msgs/msg/PointStamped"
NUMBER = "std_msgs/msg/Float64"
NUMBERS = "std_msgs/msg/Float64MultiArray"
TEXT = "std_msgs/msg/String"
TRANSFORMS = "tf2_msgs/msg/TFMessage"

IMAGE_BEFORE = "/camera/before/compressed"
IMAGE_GAZE = "/camera/gaze/compressed"
IMAGE_AFTER = "/camera/after/compressed"
CAMERA = "/camera/camera_info"
JOINT_STATES = "/joint_states"
JOINT_LOWER = "/joint_limits/lower"
JOINT_UPPER = "/joint_limits/upper"
TACTILE = "/tactile/right_hand"
HAND_POSE = "/hand/pose"
HAND_TARGET = "/hand/target"
FINGER_RATE = "/hand/finger_rate"
GAZE_TARGET = "/gaze/target"
SENTENCE = "/tutor/sentence"
TF = "/tf"
ROBOT_DESCRIPTION = "/robot_description"
TRUTH_SCENE = "/truth/scene"
TRUTH_POSES = "/truth/object_poses"
TRUTH_OUTCOME = "/truth/outcome"
CALIBRATION_EMPTY = "/calibration/empty/compressed"
CALIBRATION_MARKS = "/calibration/marks/compressed"
CALIBRATION_POSITIONS = "/calibration/mark_positions"
CALIBRATION_PATTERN = "/calibration/pattern"

_ALL: tuple[LogKind, ...] = ("trial", "instruction", "calibration")
_BOTH: tuple[LogKind, ...] = ("trial", "instruction")
_TRIAL: tuple[LogKind, ...] = ("trial",)
_INSTRUCTION: tuple[LogKind, ...] = ("instruction",)
_CALIBRATION: tuple[LogKind, ...] = ("calibration",)
_NONE: tuple[LogKind, ...] = ()
_PIXELS = "(H, W, 3)"
_J = len(JOINT_NAMES)
_TURN = 10.0  # rad: more is taken for degrees
_REACH = 10.0  # m: more is taken for millimetres

CHANNELS: tuple[Channel, ...] = (
    Channel(
        IMAGE_BEFORE,
        IMAGE,
        _PIXELS,
        "RGB, 0..255",
        CAMERA_FRAME,
        _BOTH,
        _NONE,
        "objects on the table, rest posture",
        once=True,
    ),
    Channel(
        IMAGE_GAZE,
        IMAGE,
        _PIXELS,
        "RGB, 0..255",
        CAMERA_FRAME,
        _TRIAL,
        _NONE,
        "while the robot looks at the object",
        once=True,
    ),
    Channel(
        IMAGE_AFTER, IMAGE, _PIXELS, "RGB, 0..255", CAMERA_FRAME, _TRIAL, _NONE, "when the action is over", once=True
    ),
    Channel(
        CAMERA,
        CAMERA_INFO,
        "K (3, 3), D (5,)",
        "pixels",
        CAMERA_FRAME,
        _ALL,
        _NONE,
        "intrinsics as the robot knows them",
        once=True,
    ),
    Channel(
        JOINT_STATES,
        JOINT_STATE,
        f"({_J},)",
        "rad, rad/s",
        "",
        _BOTH,
        _NONE,
        "encoders at a fixed rate; the last one is the end of the action",
        _J,
        lowest=-_TURN,
        highest=_TURN,
    ),
    Channel(
        JOINT_LOWER,
        JOINT_STATE,
        f"({_J},)",
        "rad",
        "",
        _BOTH,
        _NONE,
        "lower limits of the joints",
        _J,
        once=True,
        lowest=-_TURN,
        highest=_TURN,
    ),
    Channel(
        JOINT_UPPER,
        JOINT_STATE,
        f"({_J},)",
        "rad",
        "",
        _BOTH,
        _NONE,
        "upper limits of the joints",
        _J,
        once=True,
        lowest=-_TURN,
        highest=_TURN,
    ),
    Channel(
        TACTILE,
        NUMBERS,
        "(9,)",
        "saturated force, 0..1",
        "",
        _BOTH,
        _NONE,
        "five fingertips, four palm patches; the last one counts",
        9,
        0.0,
        1.0,
    ),
    Channel(
        HAND_POSE,
        POSE,
        "(7,)",
        "m, quaternion x y z w",
        ROOT_FRAME,
        _BOTH,
        _NONE,
        "grasp point of the right hand; the last one counts",
        7,
        lowest=-_REACH,
        highest=_REACH,
    ),
    Channel(
        HAND_TARGET,
        POINT,
        "(3,)",
        "m",
        ROOT_FRAME,
        _NONE,
        _TRIAL,
        "where the hand was sent, absent when it was not",
        3,
        lowest=-_REACH,
        highest=_REACH,
    ),
    Channel(
        FINGER_RATE,
        NUMBER,
        "()",
        "0 open .. 1 closed",
        "",
        _TRIAL,
        _NONE,
        "commanded bend of the five fingers",
        None,
        0.0,
        1.0,
        once=True,
    ),
    Channel(
        GAZE_TARGET,
        POINT,
        "(3,)",
        "m",
        ROOT_FRAME,
        _TRIAL,
        _NONE,
        "commanded fixation point",
        3,
        once=True,
        lowest=-_REACH,
        highest=_REACH,
    ),
    Channel(
        SENTENCE,
        TEXT,
        "words",
        "separated by blanks",
        "",
        _BOTH,
        _NONE,
        "what the tutor says, may be empty",
        once=True,
    ),
    Channel(
        TF,
        TRANSFORMS,
        "n × (7,)",
        "m, quaternion x y z w",
        ROOT_FRAME,
        _NONE,
        _ALL,
        "poses of the links and of the camera",
    ),
    Channel(ROBOT_DESCRIPTION, TEXT, "URDF", "", "", _NONE, _ALL, "the robot, meshes by package:// paths", once=True),
    Channel(
        TRUTH_SCENE,
        TEXT,
        "JSON",
        "m",
        ROOT_FRAME,
        _NONE,
        _BOTH,
        "objects, their words and positions, the attended one",
        once=True,
    ),
    Channel(
        TRUTH_POSES,
        POSES,
        "(M, 7)",
        "m, quaternion x y z w",
        ROOT_FRAME,
        _NONE,
        _BOTH,
        "poses of the objects with each joint state",
        lowest=-_REACH,
        highest=_REACH,
    ),
    Channel(
        TRUTH_OUTCOME,
        TEXT,
        "JSON",
        "m, N",
        ROOT_FRAME,
        _NONE,
        _BOTH,
        "what physically happened and the action word for it",
        once=True,
    ),
    Channel(
        CALIBRATION_EMPTY,
        IMAGE,
        _PIXELS,
        "RGB, 0..255",
        CAMERA_FRAME,
        _CALIBRATION,
        _NONE,
        "empty table, rest posture",
        once=True,
    ),
    Channel(
        CALIBRATION_MARKS,
        IMAGE,
        _PIXELS,
        "RGB, 0..255",
        CAMERA_FRAME,
        _CALIBRATION,
        _NONE,
        "dark dots on the table, rest posture",
        once=True,
    ),
    Channel(
        CALIBRATION_POSITIONS,
        POSES,
        "(N, 7)",
        "m, quaternion x y z w",
        ROOT_FRAME,
        _CALIBRATION,
        _NONE,
        "measured positions of the dots, by rows from far to near, each from left to right",
        once=True,
        lowest=-_REACH,
        highest=_REACH,
    ),
    Channel(
        CALIBRATION_PATTERN,
        TEXT,
        "JSON",
        "",
        "",
        _CALIBRATION,
        _NONE,
        'grid of the dots: {"rows": r, "columns": c}',
        once=True,
    ),
)

BY_TOPIC: dict[str, Channel] = {channel.topic: channel for channel in CHANNELS}
