"""Plain values that messages of a log hold, beside numbers, arrays and strings."""

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]

FISHEYE = "equidistant"
"""The model of distortion of fisheye lenses, in which a ray's distance from the centre grows with its angle."""


@dataclass(frozen=True)
class JointState:
    """Positions and velocities of named joints.

    Attributes:
        names: J joint names.
        position: (J,) radians.
        velocity: (J,) radians per second, or empty when not known.
    """

    names: tuple[str, ...]
    position: Floats
    velocity: Floats


DISTORTION_MODELS = {
    "plumb_bob": (0, 4, 5, 8, 12, 14),
    "rational_polynomial": (0, 4, 5, 8, 12, 14),
    FISHEYE: (4,),
    "": (0, 4, 5, 8, 12, 14),
}
"""Model of distortion, as ROS calls it → how many coefficients it may have (k1 k2 p1 p2 k3 …). The empty name, by
which drivers say that there is none, has only coefficients of 0."""


@dataclass(frozen=True)
class CameraInfo:
    """Camera as the robot knows it.

    Attributes:
        width: Columns of its pictures.
        height: Rows of its pictures.
        K: (3, 3) intrinsic matrix, pixels of its pictures.
        D: Coefficients of distortion, as the model has them; (5,) zeros for the simulated camera.
        frame: Frame of the camera in `/tf` (optical: x right, y down, z ahead).
        model: Model of distortion, one of `DISTORTION_MODELS`.
    """

    width: int
    height: int
    K: Floats
    D: Floats
    frame: str
    model: str = "plumb_bob"


@dataclass(frozen=True)
class Transform:
    """Pose of frame `child` in frame `parent`: (7,) x y z in metres and quaternion x y z w."""

    parent: str
    child: str
    pose: Floats


Value = str | float | Floats | Image | JointState | CameraInfo | tuple[Transform, ...]


def same(one: object, other: object) -> bool:
    """Whether two values are of one type and the same, to the last bit of every number."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return np.array_equal(one, np.asarray(other))
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(same(left, right) for left, right in zip(one, other, strict=True))
    if dataclasses.is_dataclass(one):
        return same(tuple(vars(one).values()), tuple(vars(other).values()))
    return one == other
