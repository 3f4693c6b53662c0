"""Inverse kinematics: the angles that bring the hand to a place, or the eyes to look at one. Radians and metres."""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from data_collection.log.messages import Floats
from data_collection.simulator import hand_model, robot_model
from data_collection.simulator.kinematics import HEAD, REACH, Kinematics, Pose, cross

# Neck pitch and yaw, eyes tilt and version; roll stays, vergence follows from the distance.
_GAZE = HEAD[[0, 2, 3, 4]]
_VERGENCE = HEAD[5]
_REACH_EASE = 0.005 * np.array([3.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
_GAZE_EASE = 0.05 * np.array([1.0, 1.0, 1.0, 2.0])


def reach(robot: Kinematics, position: Floats, start: Floats, comfortable: Floats) -> Floats:
    """Bring the grasp point to `position` with the palm as much downwards as the limits allow.

    Args:
        robot: Its kinematics.
        position: (3,) of the grasp point.
        start: (25,) angles to start the search from; those of head and hand are kept.
        comfortable: (25,) angles that the solution leans to where the task leaves it free.

    Returns:
        (25,) angles inside the joints' limits.
    """

    def whole(angles: Floats) -> Floats:
        posture = start.copy()
        posture[REACH] = angles
        return posture

    at = _remembered(lambda angles: robot.pose(hand_model.GRASP_LINK, whole(angles)))

    def residual(angles: Floats) -> Floats:
        pose = at(angles)
        tilt = pose.axes[:, 2] - np.array([0.0, 0.0, -1.0])
        ease = _REACH_EASE * (angles - comfortable[REACH])
        return np.concatenate([100.0 * (pose.position - position), 0.5 * tilt, ease])

    def slope(angles: Floats) -> Floats:
        pose = at(angles)
        tilt = cross(pose.angular.T, pose.axes[:, 2]).T
        return np.vstack([100.0 * pose.linear[:, REACH], 0.5 * tilt[:, REACH], np.diag(_REACH_EASE)])

    return whole(_solve(robot, residual, slope, start, REACH))


def look(robot: Kinematics, target: Floats, posture: Floats, comfortable: Floats) -> Floats:
    """Return `posture` (25,) with head and eyes turned so that both eyes fixate `target` (3,)."""

    def whole(angles: Floats) -> Floats:
        turned = posture.copy()
        turned[_GAZE] = angles
        turned[_VERGENCE] = 0.0
        return turned

    def line(pose: Pose) -> tuple[Floats, float]:
        distance = float(np.linalg.norm(target - pose.position))
        return (target - pose.position) / distance, distance

    at = _remembered(lambda angles: _between(robot.pose(robot_model.LEFT_EYE_LINK, whole(angles))))

    def residual(angles: Floats) -> Floats:
        pose = at(angles)
        ease = _GAZE_EASE * (angles - comfortable[_GAZE])
        return np.concatenate([10.0 * (pose.axes[:, 0] - line(pose)[0]), ease])

    def slope(angles: Floats) -> Floats:
        pose = at(angles)
        towards, distance = line(pose)
        axis = cross(pose.angular.T, pose.axes[:, 0]).T
        drift = -(np.eye(3) - np.outer(towards, towards)) @ pose.linear / distance
        return np.vstack([10.0 * (axis - drift)[:, _GAZE], np.diag(_GAZE_EASE)])

    turned = whole(_solve(robot, residual, slope, posture, _GAZE))
    pose = _between(robot.pose(robot_model.LEFT_EYE_LINK, turned))
    turned[_VERGENCE] = 2.0 * math.atan2(robot_model.EYE_BASELINE / 2, line(pose)[1])
    return turned


def _between(left: Pose) -> Pose:
    """Return the pose of the point between the eyes, with the direction of parallel eyes."""
    offset = -robot_model.EYE_BASELINE / 2 * left.axes[:, 1]
    return Pose(left.position + offset, left.axes, left.linear + cross(left.angular.T, offset).T, left.angular)


def _solve(robot: Kinematics, residual, slope, start: Floats, free: NDArray[np.intp]) -> Floats:  # type: ignore[no-untyped-def]
    low, high = robot.lower[free] + 1e-3, robot.upper[free] - 1e-3
    first = np.clip(start[free], low + 1e-6, high - 1e-6)
    solved = least_squares(residual, first, jac=slope, bounds=(low, high), max_nfev=60, xtol=1e-6, ftol=1e-9)
    return np.asarray(solved.x, dtype=np.float64)


def _remembered(pose: Callable[[Floats], Pose]) -> Callable[[Floats], Pose]:
    """Keep the last poses: the solver asks for the residual and, separately, for its slope at the same angles."""
    kept = lru_cache(maxsize=2)(lambda key: pose(np.frombuffer(key)))
    return lambda angles: kept(angles.tobytes())
