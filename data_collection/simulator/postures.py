"""Postures of the robot that its tasks start from and lean to, in degrees; joints not named are at 0."""

import math
from collections.abc import Mapping

import numpy as np

from data_collection.joints import JOINT_NAMES
from data_collection.log.messages import Floats
from data_collection.simulator.kinematics import HAND, Kinematics
from data_collection.simulator.robot import finger_angles

REST = {
    "neck_pitch": -32.0,
    "eyes_tilt": -26.0,
    "eyes_version": 0.0,
    "eyes_vergence": 8.0,
    "r_shoulder_pitch": 10.0,
    "r_shoulder_roll": 40.0,
    "r_shoulder_yaw": -30.0,
    "r_elbow": 96.0,
    "r_wrist_prosup": 30.0,
    "torso_pitch": 4.0,
}
"""Rest posture: head and eyes turned to the table, the right hand beside the body and out of the picture."""

COMFORTABLE = {
    **REST,
    "torso_pitch": 12.0,
    "r_shoulder_pitch": -30.0,
    "r_shoulder_roll": 30.0,
    "r_shoulder_yaw": 25.0,
    "r_elbow": 72.0,
    "r_wrist_prosup": 45.0,
    "r_wrist_pitch": -8.0,
}
"""What the inverse kinematics leans to where the task leaves it free."""


def angles_of(degrees: Mapping[str, float], kinematics: Kinematics) -> Floats:
    """Return the joints (25,) of a posture in radians, within their limits, with nearly open fingers."""
    angles = np.array([math.radians(degrees.get(name, 0.0)) for name in JOINT_NAMES])
    angles[HAND] = finger_angles(0.15)
    bounded: Floats = np.clip(angles, kinematics.lower, kinematics.upper)
    return bounded
