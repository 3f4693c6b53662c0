"""Inverse kinematics: the angles that bring the hand to a place, or the eyes to look at one. Radians and metres."""

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from data_collection.log.messages import Floats
from data_collection.simulator import hand_model, robot_model
from data_collection.simulator.kinematics import HEAD, REACH, Kinematics, Pose, cross

# Neck pitch and yaw, eyes tilt and version; roll stays, vergence follows from the distance.
_GAZE = HEAD[[0, 2, 3, 4]]
_VERGENCE = HEAD[5]
_REACH_EASE = 0.005 * np.array([3.0, 4.0, 2.0, 1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
_GAZE_EASE = 0.05 * np.array([1.0, 1.0, 1.0, 2.0])

_FROM_LIMIT = 1e-3
"""Solutions keep this far from the joints' limits, radians."""
_STEPS, _STILL, _DAMPING, _STIFF = 60, 1e-3, 1e-5, 1e8
"""Of the solver: most steps; the step, radians, that is the last; its least and its largest damping."""
_Function = Callable[[Floats], Floats]


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


def _solve(robot: Kinematics, residual: _Function, slope: _Function, start: Floats, free: NDArray[np.intp]) -> Floats:
    """Return the angles (F,) that make the squares of a residual least, within the limits of the free joints.

    Levenberg and Marquardt's damped steps; angles that would leave their limits stay there.
    """
    low, high = robot.lower[free] + _FROM_LIMIT, robot.upper[free] - _FROM_LIMIT
    angles = np.clip(start[free], low, high)
    left, damping, unit = residual(angles), _DAMPING, np.eye(len(free))
    for _ in range(_STEPS):
        slopes = slope(angles)
        gradient, curvature = slopes.T @ left, slopes.T @ slopes
        held = ((angles <= low) & (gradient > 0.0)) | ((angles >= high) & (gradient < 0.0))
        gradient[held], curvature[held], curvature[:, held] = 0.0, 0.0, 0.0
        curvature[held, held] = 1.0
        while damping < _STIFF:
            step = np.linalg.solve(curvature + damping * unit, -gradient)
            tried = np.clip(angles + step, low, high)
            remains = residual(tried)
            if remains @ remains < left @ left:
                break
            damping *= 10.0
        else:
            return angles
        moved = np.abs(tried - angles).max()
        angles, left, damping = tried, remains, max(damping / 10.0, _DAMPING)
        if moved < _STILL:
            break
    return angles


def _remembered(pose: Callable[[Floats], Pose]) -> Callable[[Floats], Pose]:
    """Keep the last poses: the solver asks for the residual and, separately, for its slope at the same angles."""
    kept = lru_cache(maxsize=2)(lambda key: pose(np.frombuffer(key)))
    return lambda angles: kept(angles.tobytes())
