"""The one table of signals: what a log of a trial, or of a calibration, holds.

Writer, reader, validator and documentation derive from `CHANNELS`.
"""

from dataclasses import dataclass
from typing import Literal

from data_collection.joints import JOINT_NAMES, TACTILE_NAMES

LogKind = Literal["trial", "instruction", "calibration"]
"""`trial`: an action was executed. `instruction`: scene and sentence only (set `generation`)."""

ROOT_FRAME = "root_link"
"""Robot frame: origin at the robot's root, x ahead, y left, z up, metres."""
CAMERA_FRAME = "left_eye_optical"
TRUTH_PREFIX = "/truth/"


@dataclass(frozen=True)
class Value:
    """What the messages of a topic hold.

    Attributes:
        type: ROS 2 message type.
        shape: Shape of the decoded value as text; letters are free sizes.
        unit: Unit and, where it has one, range of the values.
        frame: Frame that the values refer to, empty where there is none.
        length: Exact number of values where it is fixed, else None.
        lowest: Smallest value allowed, or None; likewise of the positions of joints.
        highest: Largest value allowed, or None.
    """

    type: str
    shape: str
    unit: str
    frame: str = ""
    length: int | None = None
    lowest: float | None = None
    highest: float | None = None


@dataclass(frozen=True)
class Topic:
    """One signal.

    Attributes:
        name: Of the ROS topic.
        value: What its messages hold.
        meaning: What it is, and how often.
        required: Kinds of log that must have it.
        optional: Kinds of log that may have it.
        once: Whether it may come only once in a log.
    """

    name: str
    value: Value
    meaning: str
    required: tuple[LogKind, ...] = ()
    optional: tuple[LogKind, ...] = ()
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
_CALIBRATION: tuple[LogKind, ...] = ("calibration",)

_J, _S = len(JOINT_NAMES), len(TACTILE_NAMES)
_TURN = 10.0  # rad: more is taken for degrees
_REACH = 10.0  # m: more is taken for millimetres
_METRES = "m, quaternion x y z w"

_PICTURE = Value(IMAGE, "(H, W, 3)", "RGB, 0..255", CAMERA_FRAME)
_ENCODERS = Value(JOINT_STATE, f"({_J},)", "rad, rad/s", "", _J, -_TURN, _TURN)
_LIMITS = Value(JOINT_STATE, f"({_J},)", "rad", "", _J, -_TURN, _TURN)
_TOUCH = Value(NUMBERS, f"({_S},)", "saturated force, 0..1", "", _S, 0.0, 1.0)
_PLACE = Value(POINT, "(3,)", "m", ROOT_FRAME, 3, -_REACH, _REACH)
_POSE = Value(POSE, "(7,)", _METRES, ROOT_FRAME, 7, -_REACH, _REACH)
_RATE = Value(NUMBER, "()", "0 open .. 1 closed", "", None, 0.0, 1.0)
_WORDS = Value(TEXT, "words", "separated by blanks")
_INTRINSICS = Value(CAMERA_INFO, "K (3, 3), D (n,)", "pixels", CAMERA_FRAME)
_LINKS = Value(TRANSFORMS, "n × (7,)", _METRES, ROOT_FRAME)
_URDF = Value(TEXT, "URDF", "")
_SCENE = Value(TEXT, "JSON", "m", ROOT_FRAME)
_OUTCOME = Value(TEXT, "JSON", "m, N", ROOT_FRAME)
_OBJECTS = Value(POSES, "(M, 7)", _METRES, ROOT_FRAME, None, -_REACH, _REACH)
_DOTS = Value(POSES, "(N, 7)", _METRES, ROOT_FRAME, None, -_REACH, _REACH)
_GRID = Value(TEXT, "JSON", "")

TOPICS: tuple[Topic, ...] = (
    Topic(IMAGE_BEFORE, _PICTURE, "objects on the table, rest posture", _BOTH, once=True),
    Topic(IMAGE_GAZE, _PICTURE, "while the robot looks at the object", _TRIAL, once=True),
    Topic(IMAGE_AFTER, _PICTURE, "when the action is over", _TRIAL, once=True),
    Topic(CAMERA, _INTRINSICS, "intrinsics as the robot knows them", _ALL, once=True),
    Topic(JOINT_STATES, _ENCODERS, "encoders at a fixed rate; the last one is the end of the action", _BOTH),
    Topic(JOINT_LOWER, _LIMITS, "lower limits of the joints", _BOTH, once=True),
    Topic(JOINT_UPPER, _LIMITS, "upper limits of the joints", _BOTH, once=True),
    Topic(TACTILE, _TOUCH, "five fingertips, four palm patches; the last one counts", _BOTH),
    Topic(HAND_POSE, _POSE, "grasp point of the right hand; the last one counts", _BOTH),
    Topic(HAND_TARGET, _PLACE, "where the hand was sent, absent when it was not", optional=_TRIAL),
    Topic(FINGER_RATE, _RATE, "commanded bend of the five fingers", _TRIAL, once=True),
    Topic(GAZE_TARGET, _PLACE, "commanded fixation point", _TRIAL, once=True),
    Topic(SENTENCE, _WORDS, "what the tutor says, may be empty", _BOTH, once=True),
    Topic(TF, _LINKS, "poses of the links and of the camera", optional=_ALL),
    Topic(ROBOT_DESCRIPTION, _URDF, "the robot, meshes by package:// paths", optional=_ALL, once=True),
    Topic(TRUTH_SCENE, _SCENE, "objects, their words and positions, the attended one", optional=_BOTH, once=True),
    Topic(TRUTH_POSES, _OBJECTS, "poses of the objects with each joint state", optional=_BOTH),
    Topic(TRUTH_OUTCOME, _OUTCOME, "what physically happened and the action word for it", optional=_BOTH, once=True),
    Topic(CALIBRATION_EMPTY, _PICTURE, "empty table, rest posture", _CALIBRATION, once=True),
    Topic(CALIBRATION_MARKS, _PICTURE, "dark dots on the table, rest posture", _CALIBRATION, once=True),
    Topic(
        CALIBRATION_POSITIONS,
        _DOTS,
        "measured positions of the dots, by rows from far to near, each from left to right",
        _CALIBRATION,
        once=True,
    ),
    Topic(CALIBRATION_PATTERN, _GRID, 'grid of the dots: {"rows": r, "columns": c}', _CALIBRATION, once=True),
)

BY_TOPIC: dict[str, Topic] = {topic.name: topic for topic in TOPICS}
