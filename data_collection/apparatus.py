# ruff: noqa: RUF009 — `setting` is `dataclasses.field` with a documentation and a range
"""Settings of each thing in the simulated laboratory, from the objects on the table to the tutor."""

from dataclasses import dataclass
from typing import Any

from data_collection.limits import WORD_PATTERN
from data_collection.schema import setting
from data_collection.shapes import BUILDERS

Color = tuple[float, float, float]

VECTOR: dict[str, Any] = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
RGB: dict[str, Any] = {**VECTOR, "items": {"type": "number", "minimum": 0, "maximum": 1}}


@dataclass(frozen=True)
class ObjectKind:
    """One object that may stand on the table."""

    object: str = setting(doc="word of the object channel", pattern=WORD_PATTERN)
    color: str = setting(doc="word of the color channel, a key of `colors`", pattern=WORD_PATTERN)
    shape: str = setting(doc="mesh", enum=list(BUILDERS))
    size: float = setting(0.056, doc="largest horizontal size, metres", low=0.03, high=0.09)
    height: float = setting(0.056, doc="height, metres (a ball is as high as wide)", low=0.02, high=0.09)
    style: int = setting(0, doc="variant of the mesh (car 0..3, cup 0..2, star 0..1)", low=0, high=3)
    shade: int = setting(0, doc="which shade of its color it has, counted from 0", low=0)
    mass: float = setting(0.06, doc="kilograms", low=0.005, high=1.0)


@dataclass(frozen=True)
class Table:
    """The table."""

    height: float = setting(-0.06, doc="height of its top, metres, robot frame", low=-0.15, high=0.05)
    near: float = setting(0.13, doc="x of its near edge, metres", low=0.1, high=0.2)
    far: float = setting(0.75, doc="x of its far edge, metres", low=0.5, high=1.5)
    width: float = setting(1.1, doc="width, metres", low=0.6, high=2.0)
    color: Color = setting((0.95, 0.95, 0.94), doc="red, green, blue, 0..1", **RGB)
    cloth: float = setting(0.0, doc="strength of a woven texture, 0 none", low=0.0, high=1.0)


@dataclass(frozen=True)
class Light:
    """One lamp, and how it varies from trial to trial."""

    direction: Color = setting((0.3, 0.7, 2.0), doc="from the table to the lamp", **VECTOR)
    ambient: float = setting(0.62, doc="share of light from everywhere", low=0.0, high=1.0)
    diffuse: float = setting(0.38, doc="share of light from the lamp", low=0.0, high=1.0)
    shadow: bool = setting(True, doc="whether things cast shadows")
    direction_spread: float = setting(
        0.0, doc="standard deviation of each number of the direction", low=0.0, high=1.0
    )
    brightness_spread: float = setting(
        0.0, doc="standard deviation of a factor on ambient and diffuse", low=0.0, high=0.3
    )


@dataclass(frozen=True)
class Camera:
    """The camera in the left eye."""

    width: int = setting(400, doc="columns", low=160, high=1280)
    height: int = setting(300, doc="rows", low=120, high=960)
    view: float = setting(64.0, doc="vertical angle of view, degrees", low=30.0, high=90.0)
    noise: float = setting(0.0, doc="standard deviation of a pixel's noise, grey levels of 255", low=0.0, high=30.0)
    blur: float = setting(0.0, doc="standard deviation of the blur, pixels", low=0.0, high=3.0)
    calibration_error: float = setting(
        0.0, doc="standard deviation of relative errors of the logged focal lengths and centre", low=0.0, high=0.05
    )
    mark_error: float = setting(
        0.0, doc="standard deviation of the measured positions of the calibration dots, metres", low=0.0, high=0.01
    )


@dataclass(frozen=True)
class Noise:
    """Noise of the robot's own senses."""

    joints: float = setting(0.0, doc="standard deviation of the joint encoders, degrees", low=0.0, high=5.0)
    gaze: float = setting(
        0.005, doc="standard deviation of the fixation point along x and y, metres", low=0.0, high=0.03
    )
    tactile: float = setting(0.0, doc="standard deviation of the touch sensors, of their range", low=0.0, high=0.3)


@dataclass(frozen=True)
class Motion:
    """How an action is drawn and carried out."""

    look_share: float = setting(0.20, doc="probability that the robot only looks", low=0.0, high=1.0)
    target_spread: float = setting(
        0.010, doc="standard deviation of the hand's target along x and y, metres", low=0.0, high=0.05
    )
    height_mean: float = setting(
        0.006, doc="mean height of the hand's target above the best grasp, metres", low=-0.02, high=0.1
    )
    height_spread: float = setting(0.014, doc="its standard deviation, metres", low=0.0, high=0.05)
    height_least: float = setting(-0.008, doc="lowest height drawn, metres", low=-0.03, high=0.05)
    clearance: float = setting(
        0.10, doc="height over the target from which the hand comes down, metres", low=0.03, high=0.15
    )
    gaze_time: float = setting(0.5, doc="seconds for turning head and eyes", low=0.1, high=5.0)
    transfer_time: float = setting(0.9, doc="seconds from rest to above the target", low=0.3, high=5.0)
    descent_time: float = setting(0.7, doc="seconds from there to the target", low=0.3, high=5.0)
    bend_time: float = setting(0.7, doc="seconds for bending and holding the fingers", low=0.3, high=5.0)
    lift_time: float = setting(1.0, doc="seconds of the lift test", low=0.3, high=5.0)
    lift_height: float = setting(0.06, doc="metres of the lift test", low=0.02, high=0.1)
    log_rate: float = setting(20.0, doc="joint, touch and hand messages per second", low=1.0, high=240.0)


@dataclass(frozen=True)
class Hand:
    """Forces of the right hand."""

    finger_torque: float = setting(0.25, doc="largest torque of a finger joint, N·m", low=0.01, high=5.0)
    friction: float = setting(1.2, doc="Coulomb friction of hand and objects", low=0.1, high=3.0)
    saturation: float = setting(3.0, doc="force at which a touch sensor reads 1, newtons", low=0.1, high=50.0)


@dataclass(frozen=True)
class Tutor:
    """Thresholds by which the tutor names an action."""

    moved: float = setting(
        0.03, doc="below this distance from its rest position the hand did not move, metres", low=0.005, high=0.1
    )
    contact: float = setting(0.05, doc="force from which it counts as contact, newtons", low=0.0, high=5.0)
    bend: float = setting(
        0.25, doc="finger rate from which the fingers are closed rather than open", low=0.0, high=1.0
    )
    held: float = setting(0.5, doc="share of the lift by which the object must have risen", low=0.1, high=1.0)
