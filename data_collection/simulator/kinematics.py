"""Forward kinematics of the robot, from its URDF, in numpy: to plan without moving the acting robot.

Angles in radians, lengths in metres, everything in the robot frame. The 30 revolute joints of the model follow the 25
logged ones of `joints.JOINT_NAMES` by a matrix: version and vergence turn both eyes, one joint spreads three
fingers, one bends ring and little finger.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from data_collection.joints import ARM_JOINTS, HAND_JOINTS, HEAD_JOINTS, JOINT_NAMES, TORSO_JOINTS
from data_collection.log.messages import Floats

_COUPLED: Mapping[str, Mapping[str, float]] = {
    "eyes_version": {"l_eye_pan": 1.0, "r_eye_pan": 1.0},
    "eyes_vergence": {"l_eye_pan": -0.5, "r_eye_pan": 0.5},
    "r_hand_finger": {"r_index_spread": 0.25, "r_ring_spread": 0.12, "r_little_spread": 0.25},
    "r_pinky": {"r_ring_proximal": 0.5, "r_ring_distal": 0.5, "r_little_proximal": 0.5, "r_little_distal": 0.5},
}
"""Logged joint → the model's joints that it drives, with factors; all others drive the joint of their own name."""

_LIMITS_DEGREES = {
    "eyes_version": (-50.0, 50.0),
    "eyes_vergence": (0.0, 50.0),
    "r_hand_finger": (0.0, 60.0),
    "r_pinky": (0.0, 180.0),
}

BASE_TURN = np.diag([-1.0, -1.0, 1.0, 1.0])
"""The URDF's robot looks along −x: turned by 180 degrees, root link and robot frame are one."""

_UNIT = np.eye(4)


def joint_index(names: Sequence[str]) -> NDArray[np.intp]:
    """Return where logged joints stand in `JOINT_NAMES`."""
    return np.array([JOINT_NAMES.index(name) for name in names])


HEAD = joint_index(HEAD_JOINTS)
HAND = joint_index(HAND_JOINTS)
REACH = joint_index(TORSO_JOINTS + ARM_JOINTS)


@dataclass(frozen=True)
class _Joint:
    parent: str
    child: str
    origin: Floats
    axis: Floats | None
    number: int
    cross: Floats
    square: Floats

    def turned(self, angle: float) -> Floats:
        """Return the (4, 4) rotation by `angle` about the axis (Rodrigues)."""
        return _UNIT + (math.sin(angle) * self.cross + (1.0 - math.cos(angle)) * self.square)


@dataclass(frozen=True)
class Pose:
    """Pose of a link and how it changes.

    Attributes:
        position: (3,) of its frame.
        axes: (3, 3) its x, y, z as columns.
        linear: (3, 25) derivative of the position by the logged joints.
        angular: (3, 25) rotation vector per radian of each logged joint.
    """

    position: Floats
    axes: Floats
    linear: Floats
    angular: Floats

    def flat(self) -> Floats:
        """Return (7,): x y z in metres, quaternion x y z w."""
        return np.concatenate([self.position, Rotation.from_matrix(self.axes).as_quat(canonical=True)])


class Kinematics:
    """Kinematic tree of the robot.

    Attributes:
        model_joints: Names of the model's revolute joints.
        to_model: (30, 25) from logged to the model's joints.
        from_model: (25, 30) back.
        lower: (25,) lower limits of the logged joints.
        upper: (25,) upper limits.
    """

    def __init__(self, urdf: str) -> None:
        joints = ElementTree.fromstring(urdf).findall("joint")
        moving = [joint for joint in joints if joint.get("type") == "revolute"]
        self.model_joints = tuple(str(joint.get("name")) for joint in moving)
        tree = {entry.child: entry for entry in map(self._joint, joints)}
        self._chains = {link: _chain(tree, link) for link in tree}
        bounds = {str(joint.get("name")): _limits(joint) for joint in moving}
        bounds |= {name: (math.radians(low), math.radians(high)) for name, (low, high) in _LIMITS_DEGREES.items()}
        self.lower: Floats = np.array([bounds[name][0] for name in JOINT_NAMES])
        self.upper: Floats = np.array([bounds[name][1] for name in JOINT_NAMES])
        self.to_model = np.zeros((len(self.model_joints), len(JOINT_NAMES)))
        for column, logged in enumerate(JOINT_NAMES):
            for name, factor in _COUPLED.get(logged, {logged: 1.0}).items():
                self.to_model[self.model_joints.index(name), column] = factor
        self.from_model: Floats = np.asarray(np.linalg.pinv(self.to_model), dtype=np.float64)

    def _joint(self, joint: ElementTree.Element) -> _Joint:
        name = str(joint.get("name"))
        origin = np.eye(4)
        origin[:3, 3] = _numbers(joint, "origin", "xyz")
        origin[:3, :3] = Rotation.from_euler("xyz", _numbers(joint, "origin", "rpy")).as_matrix()
        parent, child = joint.find("parent"), joint.find("child")
        links = [str(link.get("link")) for link in (parent, child) if link is not None]
        cross = np.zeros((4, 4))
        if joint.get("type") != "revolute":
            return _Joint(links[0], links[1], origin, None, -1, cross, cross)
        axis = _numbers(joint, "axis", "xyz")
        x, y, z = axis
        cross[:3, :3] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
        return _Joint(links[0], links[1], origin, axis, self.model_joints.index(name), cross, cross @ cross)

    def pose(self, link: str, angles: Floats) -> Pose:
        """Return the pose of a link at the logged joints' angles (25,)."""
        turns = self.to_model @ angles
        frame = BASE_TURN
        axes, centres, numbers = [], [], []
        for joint in self._chains[link]:
            frame = frame @ joint.origin
            if joint.axis is not None:
                axes.append(frame[:3, :3] @ joint.axis)
                centres.append(frame[:3, 3])
                numbers.append(joint.number)
                frame = frame @ joint.turned(turns[joint.number])
        angular, linear = np.zeros((3, len(turns))), np.zeros((3, len(turns)))
        if numbers:
            columns = np.array(axes)
            angular[:, numbers] = columns.T
            linear[:, numbers] = cross(columns, frame[:3, 3] - np.array(centres)).T
        return Pose(frame[:3, 3], frame[:3, :3], linear @ self.to_model, angular @ self.to_model)


def rotation(quaternion: Floats) -> Floats:
    """Return the (3, 3) rotation matrix of a quaternion x y z w."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _chain(tree: Mapping[str, _Joint], link: str) -> tuple[_Joint, ...]:
    """Return the joints from the root to a link."""
    chain: list[_Joint] = []
    while link in tree:
        chain.insert(0, tree[link])
        link = chain[0].parent
    return tuple(chain)


def cross(rows: Floats, others: Floats) -> Floats:
    """Return the cross products of rows (N, 3) with rows (N, 3) or one vector, at a tenth of `np.cross`."""
    (a, b, c), (x, y, z) = rows.T, others.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=1)


def _numbers(joint: ElementTree.Element, tag: str, key: str) -> Floats:
    element = joint.find(tag)
    text = "0 0 0" if element is None else element.get(key, "0 0 0")
    return np.array([float(value) for value in text.split()])


def _limits(joint: ElementTree.Element) -> tuple[float, float]:
    limit = joint.find("limit")
    if limit is None:
        raise ValueError(f"joint {joint.get('name')} has no limits")
    return float(limit.get("lower", "nan")), float(limit.get("upper", "nan"))
