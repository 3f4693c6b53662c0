"""Settings of each thing in the simulated laboratory, from the objects on the table to the tutor."""

from typing import TYPE_CHECKING, Literal, TypeAlias

from pydantic import Field

from data_collection.shapes import BUILDERS
from data_collection.strict_model import Color, StrictModel, Vector, Word

if TYPE_CHECKING:
    ShapeName: TypeAlias = str
else:
    ShapeName = Literal[tuple(BUILDERS)]


class ObjectKind(StrictModel):
    """One object that may stand on the table."""

    object: Word = Field(description="word of the object channel")
    color: Word = Field(description="word of the color channel, a key of `colors`")
    shape: ShapeName = Field(description="mesh")
    size: float = Field(0.056, description="largest horizontal size, metres", ge=0.03, le=0.09)
    height: float = Field(0.056, description="height, metres (a ball is as high as wide)", ge=0.02, le=0.09)
    style: int = Field(0, description="variant of the mesh (car 0..3, cup 0..2, star 0..1)", ge=0, le=3)
    shade: int = Field(0, description="which shade of its color it has, counted from 0", ge=0)
    mass: float = Field(0.06, description="kilograms", ge=0.005, le=1.0)


class Table(StrictModel):
    """The table."""

    height: float = Field(-0.06, description="height of its top, metres, robot frame", ge=-0.15, le=0.05)
    near: float = Field(0.13, description="x of its near edge, metres", ge=0.1, le=0.2)
    far: float = Field(0.75, description="x of its far edge, metres", ge=0.5, le=1.5)
    width: float = Field(1.1, description="width, metres", ge=0.6, le=2.0)
    color: Color = Field((0.95, 0.95, 0.94), description="red, green, blue, 0..1")
    cloth: float = Field(0.0, description="strength of a woven texture, 0 none", ge=0.0, le=1.0)


class Light(StrictModel):
    """One lamp, and how it varies from trial to trial."""

    direction: Vector = Field((0.3, 0.7, 2.0), description="from the table to the lamp")
    ambient: float = Field(0.62, description="share of light from everywhere", ge=0.0, le=1.0)
    diffuse: float = Field(0.38, description="share of light from the lamp", ge=0.0, le=1.0)
    shadow: bool = Field(True, description="whether things cast shadows")
    direction_spread: float = Field(
        0.0, description="standard deviation of each number of the direction", ge=0.0, le=1.0
    )
    brightness_spread: float = Field(
        0.0, description="standard deviation of a factor on ambient and diffuse", ge=0.0, le=0.3
    )


class Camera(StrictModel):
    """The camera in the left eye."""

    width: int = Field(400, description="columns", ge=160, le=1280)
    height: int = Field(300, description="rows", ge=120, le=960)
    view: float = Field(64.0, description="vertical angle of view, degrees", ge=30.0, le=90.0)
    noise: float = Field(
        0.0, description="standard deviation of a pixel's noise, grey levels of 255", ge=0.0, le=30.0
    )
    blur: float = Field(0.0, description="standard deviation of the blur, pixels", ge=0.0, le=3.0)
    calibration_error: float = Field(
        0.0,
        description="standard deviation of relative errors of the logged focal lengths and centre",
        ge=0.0,
        le=0.05,
    )
    mark_error: float = Field(
        0.0,
        description="standard deviation of the measured positions of the calibration dots, metres",
        ge=0.0,
        le=0.01,
    )


class Noise(StrictModel):
    """Noise of the robot's own senses."""

    joints: float = Field(0.0, description="standard deviation of the joint encoders, degrees", ge=0.0, le=5.0)
    gaze: float = Field(
        0.005, description="standard deviation of the fixation point along x and y, metres", ge=0.0, le=0.03
    )
    tactile: float = Field(0.0, description="standard deviation of the touch sensors, of their range", ge=0.0, le=0.3)


class Motion(StrictModel):
    """How an action is drawn and carried out."""

    look_share: float = Field(0.20, description="probability that the robot only looks", ge=0.0, le=1.0)
    target_spread: float = Field(
        0.010, description="standard deviation of the hand's target along x and y, metres", ge=0.0, le=0.05
    )
    height_mean: float = Field(
        0.006, description="mean height of the hand's target above the best grasp, metres", ge=-0.02, le=0.1
    )
    height_spread: float = Field(0.014, description="its standard deviation, metres", ge=0.0, le=0.05)
    height_least: float = Field(-0.008, description="lowest height drawn, metres", ge=-0.03, le=0.05)
    clearance: float = Field(
        0.10, description="height over the target from which the hand comes down, metres", ge=0.03, le=0.15
    )
    gaze_time: float = Field(0.5, description="seconds for turning head and eyes", ge=0.1, le=5.0)
    transfer_time: float = Field(0.9, description="seconds from rest to above the target", ge=0.3, le=5.0)
    descent_time: float = Field(0.7, description="seconds from there to the target", ge=0.3, le=5.0)
    bend_time: float = Field(0.7, description="seconds for bending and holding the fingers", ge=0.3, le=5.0)
    lift_time: float = Field(1.0, description="seconds of the lift test", ge=0.3, le=5.0)
    lift_height: float = Field(0.06, description="metres of the lift test", ge=0.02, le=0.1)
    log_rate: float = Field(20.0, description="joint, touch and hand messages per second", ge=1.0, le=240.0)


class Hand(StrictModel):
    """Forces of the right hand."""

    finger_torque: float = Field(0.25, description="largest torque of a finger joint, N·m", ge=0.01, le=5.0)
    friction: float = Field(1.2, description="Coulomb friction of hand and objects", ge=0.1, le=3.0)
    saturation: float = Field(3.0, description="force at which a touch sensor reads 1, newtons", ge=0.1, le=50.0)


class Tutor(StrictModel):
    """Thresholds by which the tutor names an action."""

    moved: float = Field(
        0.03, description="below this distance from its rest position the hand did not move, metres", ge=0.005, le=0.1
    )
    contact: float = Field(0.05, description="force from which it counts as contact, newtons", ge=0.0, le=5.0)
    bend: float = Field(
        0.25, description="finger rate from which the fingers are closed rather than open", ge=0.0, le=1.0
    )
    held: float = Field(0.5, description="share of the lift by which the object must have risen", ge=0.1, le=1.0)
