"""The iCub in PyBullet: motors, joint sensors, touch, by the names and units of the log."""

import math
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.log.messages import Floats
from data_collection.simulator import hand_model
from data_collection.simulator.kinematics import Kinematics, rotation
from data_collection.simulator.scene import TIME_STEP, quiet

_TORSO_TORQUE, _NECK_TORQUE, _ARM_TORQUE = 60.0, 20.0, 12.0
_POSITION_GAIN, _VELOCITY_GAIN = 0.35, 1.0
_HAND_PARTS = ("r_thumb", "r_index", "r_middle", "r_ring", "r_little")


class Robot:
    """The acting robot.

    Attributes:
        kinematics: Its joints and limits.
        body: PyBullet's number of the robot.
        links: Link name → PyBullet's number.
    """

    def __init__(self, client: Any, urdf: str, kinematics: Kinematics) -> None:
        self._client = client
        self.kinematics = kinematics
        with tempfile.TemporaryDirectory() as folder, quiet():
            path = Path(folder, "robot.urdf")
            path.write_text(urdf)
            # The model looks along −x: turned about z, world and robot frame are one.
            self.body: int = client.loadURDF(
                str(path),
                baseOrientation=(0.0, 0.0, 1.0, 0.0),
                useFixedBase=True,
                flags=client.URDF_USE_INERTIA_FROM_FILE,
            )
        self.links: dict[str, int] = {}
        numbers: dict[str, int] = {}
        for number in range(client.getNumJoints(self.body)):
            record = client.getJointInfo(self.body, number)
            self.links[record[12].decode()] = number
            numbers[record[1].decode()] = number
        self._joints = [numbers[name] for name in kinematics.model_joints]
        self._torque = np.array([_torque(name) for name in kinematics.model_joints])
        self._position_gains = np.full(len(self._joints), _POSITION_GAIN)
        self._velocity_gains = np.full(len(self._joints), _VELOCITY_GAIN)
        self._turned = self._turning = np.zeros(len(self._joints))
        self._tips = [self.links[f"r_{finger.name}_distal_phalanx"] for finger in hand_model.FINGERS]

    def set_finger_torque(self, torque: float, friction: float) -> None:
        """Set the largest torque (N·m) of the finger joints and the friction of the hand."""
        fingers = [name.startswith(_HAND_PARTS) for name in self.kinematics.model_joints]
        self._torque[np.array(fingers)] = torque
        for name, link in self.links.items():
            if name.startswith((*_HAND_PARTS, hand_model.PALM_LINK)):
                self._client.changeDynamics(self.body, link, lateralFriction=friction, spinningFriction=0.01)

    def place(self, angles: Floats) -> None:
        """Put all joints at `angles` (25,) at once, at rest: to begin a trial, or to draw what was recorded."""
        self._turned = self.kinematics.to_model @ angles
        self._turning = np.zeros(len(self._turned))
        self.show()

    def glide(self, angles: Floats, velocities: Floats) -> None:
        """Move by one step as `drive` does where nothing is touched, without the physics: from where `place` put it.

        The motors hold gravity, so that a step's velocity is the one that they are told.
        """
        missing = self.kinematics.to_model @ angles - self._turned
        self._turning = _POSITION_GAIN * missing / TIME_STEP + self.kinematics.to_model @ velocities
        self._turned = self._turned + TIME_STEP * self._turning

    def show(self) -> None:
        """Tell the physics engine where the gliding robot is, and how fast."""
        self._client.resetJointStatesMultiDof(
            self.body, self._joints, self._turned[:, None].tolist(), self._turning[:, None].tolist()
        )

    def near(self, bodies: Sequence[int], distance: float) -> bool:
        """Return whether any part that can touch is nearer to a body than a distance, metres, as last shown."""
        return any(self._client.getClosestPoints(self.body, body, distance) for body in bodies)

    def drive(self, angles: Floats, velocities: Floats) -> None:
        """Send the motors to `angles` (25,) with `velocities` (25,) as feed-forward, radians and seconds."""
        self._client.setJointMotorControlArray(
            self.body,
            self._joints,
            self._client.POSITION_CONTROL,
            targetPositions=self.kinematics.to_model @ angles,
            targetVelocities=self.kinematics.to_model @ velocities,
            forces=self._torque,
            positionGains=self._position_gains,
            velocityGains=self._velocity_gains,
        )

    def joint_state(self) -> tuple[Floats, Floats]:
        """Return positions (25,) and velocities (25,) of the logged joints."""
        states = self._client.getJointStates(self.body, self._joints)
        values = np.array([state[:2] for state in states])
        return self.kinematics.from_model @ values[:, 0], self.kinematics.from_model @ values[:, 1]

    def link_pose(self, name: str) -> Floats:
        """Return the pose (7,) of a link's frame in the robot frame: x y z, quaternion x y z w."""
        state = self._client.getLinkState(self.body, self.links[name], computeForwardKinematics=1)
        return np.array([*state[4], *state[5]])

    def link_poses(self) -> list[tuple[str, Floats]]:
        """Return name and pose (7,) of every link."""
        return [(name, self.link_pose(name)) for name in self.links]

    def contact_forces(self, bodies: Sequence[int]) -> dict[int, Floats]:
        """Return the contact forces of the hand on each body that it touches.

        Returns:
            Body → (10,) newtons: the nine sensors of `joints.TACTILE_NAMES`, then all other parts of the arm.
        """
        forces: dict[int, Floats] = {}
        for body in bodies:
            for point in self._client.getContactPoints(self.body, body):
                if point[9] > 0.0:
                    parts = forces.setdefault(body, np.zeros(10))
                    parts[self._sensor(point[3], np.array(point[5]))] += point[9]
        return forces

    def _sensor(self, link: int, position: Floats) -> int:
        """Return which touch sensor lies at a contact on a link; 9 is none."""
        if link in self._tips:
            return self._tips.index(link)
        if link != self.links[hand_model.PALM_LINK]:
            return 9
        palm = self.link_pose(hand_model.PALM_LINK)
        local = rotation(palm[3:]).T @ (position - palm[:3])
        if local[2] < hand_model.PALM_CENTRE[2]:
            return 9  # the back of the hand has no skin
        return 5 + 2 * int(local[0] < hand_model.PALM_CENTRE[0]) + int(local[1] > 0.0)


def finger_angles(rate: float) -> Floats:
    """Return the nine hand angles, radians, for a bend of all five fingers by `rate`, 0 open .. 1 closed."""
    # The thumb bends mostly at its tip: it meets the object below its middle and does not push it out of the hand.
    spread, oppose = 12.0 * (1.0 - rate), 88.0
    thumb, thumb_tip = 2.0 + 36.0 * rate, 2.0 + 74.0 * rate
    finger, tip = 8.0 + 64.0 * rate, 8.0 + 76.0 * rate
    degrees = [spread, oppose, thumb, thumb_tip, finger, tip, finger, tip, finger + tip]
    return np.array([math.radians(angle) for angle in degrees])


def _torque(name: str) -> float:
    if name.startswith("torso"):
        return _TORSO_TORQUE
    return _NECK_TORQUE if name.startswith(("neck", "eyes", "l_eye", "r_eye")) else _ARM_TORQUE
