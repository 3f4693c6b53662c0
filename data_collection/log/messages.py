"""Plain values that messages of a log hold, beside numbers, arrays and strings."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]


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


@dataclass(frozen=True)
class CameraInfo:
    """Pinhole camera as the robot knows it.

    Attributes:
        width: Image columns.
        height: Image rows.
        K: (3, 3) intrinsic matrix, pixels.
        D: (5,) distortion k1 k2 p1 p2 k3 (`plumb_bob`); zeros for the simulated camera.
        frame: Frame of the camera in `/tf` (optical: x right, y down, z ahead).
    """

    width: int
    height: int
    K: Floats
    D: Floats
    frame: str


@dataclass(frozen=True)
class Transform:
    """Pose of frame `child` in frame `parent`: (7,) x y z in metres and quaternion x y z w."""

    parent: str
    child: str
    pose: Floats


Value = str | float | Floats | Image | JointState | CameraInfo | tuple[Transform, ...]
