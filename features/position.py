"""Where an object stands on the table, from its outline in the image.

A homography maps points of the table's plane, and what stands on the table rises above it. So the outline is
explained as that of an upright solid on the table, and the middle of the solid's foot is the position. The solid
covers boxes, cylinders, cups, balls and shapes in between; of any other object it takes the size.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from features.homography import Array, Camera, to_pixels, to_table, undistorted

_DIRECTIONS = 2 * np.pi * np.arange(32) / 32
_FACING = np.column_stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])
_COSINE, _SINE = _FACING.T
_LATITUDES = np.linspace(-np.pi / 2, np.pi / 2, 9)
_REACH = 0.3  # metres that the fit may move from where the outline's foot is
_HABIT = np.array([1.0, 10.0, 3.0])  # pixels; where the outline does not tell: as high and deep as wide, upright

# x, y, then log radius, log ratio of the foot's axes, its turn, squareness, log height, roundness, taper
_LOWEST = np.array([-_REACH, -_REACH, -7.0, -1.0, -2.4, 0.0, -7.0, 0.02, -0.6])
_HIGHEST = np.array([_REACH, _REACH, -1.0, 1.0, 2.4, 0.9, 0.0, 1.0, 0.6])
_SCALE = np.array([0.01, 0.01, 0.2, 0.2, 0.3, 0.3, 0.2, 0.3, 0.3])
_TURNS = (0.0, np.pi / 4)  # where the fit starts; the second only if the first fits badly
_GOOD_COST = 2.0  # sum of losses, square pixels
_MOST_STEPS = 40
_STEP = 1e-7  # for the slopes of the extents


def standing_position(mask: NDArray[np.bool_], camera: Camera) -> NDArray[np.float64]:
    """Return the position (2,) of the object with this mask on the table, metres in the robot frame.

    Fits place, size and form of the solid to the outline's extents in 32 directions of the image. Where the
    image's edge cuts the object off, the solid may extend further.

    Args:
        mask: bool (H, W) of the object, not empty.
        camera: The view of the table.

    Raises:
        ValueError: The mask is empty.
    """
    from scipy.optimize import least_squares

    hull = _hull(mask)
    at_edge = np.any((hull < 0) | (hull > np.array(mask.shape[::-1]) - 1), axis=1)
    outline = undistorted(hull, camera.matrix, camera.distortion, camera.model)
    reached = outline @ _FACING.T
    seen, cut_off = reached.max(axis=0), np.take(at_edge, reached.argmax(axis=0))
    low, high = outline.min(axis=0), outline.max(axis=0)
    level = 0.8 * high[1] + 0.2 * low[1]
    across = np.array([low[0], (low[0] + high[0]) / 2, high[0]])
    left, middle, right = to_table(camera, np.column_stack([across, np.full(3, level)]))
    radius = float(np.clip(np.linalg.norm(right - left) / 2, 0.005, 0.2))

    def off(parameters: Array) -> Array:
        extent = (to_pixels(camera, _solid(middle, parameters)) @ _FACING.T).max(axis=-2)
        outside = np.where(cut_off, np.minimum(extent - seen, 0), extent - seen)
        slimness = parameters[..., 6] - parameters[..., 2] - np.log(2)
        habit = _HABIT * np.stack([slimness, parameters[..., 3], parameters[..., 8]], axis=-1)
        return np.concatenate([outside, habit], axis=-1)

    def slope(parameters: Array) -> Array:  # all differences at once: most of the time is spent here
        return (off(parameters + _STEP * np.eye(len(parameters))) - off(parameters)).T / _STEP

    fits = []
    bounds = (_LOWEST, _HIGHEST)
    for turn in _TURNS:
        start = [0.0, 0.0, np.log(radius), 0.0, turn, 0.4, np.log(2 * radius), 0.3, 0.0]
        fit = least_squares(off, start, slope, bounds=bounds, loss="soft_l1", x_scale=_SCALE, max_nfev=_MOST_STEPS)
        fits.append(fit)
        if fit.cost <= _GOOD_COST:
            break
    best = min(fits, key=lambda fit: float(fit.cost))
    return np.asarray(middle + best.x[:2], dtype=np.float64)


def _hull(mask: NDArray[np.bool_]) -> Array:
    """Return the corners (n, 2) of the pixels on the convex outline of a mask."""
    import cv2

    rows, columns = np.nonzero(mask)
    if rows.size == 0:
        raise ValueError("the mask of an object is empty")
    hull = cv2.convexHull(np.column_stack([columns, rows]).astype(np.int32)).reshape(-1, 1, 2)
    corners = np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]])
    return np.asarray(hull + corners, dtype=np.float64).reshape(-1, 2)


def _solid(origin: Array, parameters: Array) -> Array:
    """Return points (…, n, 3) on upright superellipsoids with parameters (…, 9)."""
    columns = np.moveaxis(parameters, -1, 0)[..., None, None]
    x, y, log_radius, log_ratio, turn, squareness, log_height, roundness, taper = columns
    power = 2 / (1 - squareness)
    foot = (np.abs(_COSINE) ** power + np.abs(_SINE) ** power) ** (-1 / power)
    along = np.exp(log_radius + log_ratio) * foot * _COSINE
    across = np.exp(log_radius - log_ratio) * foot * _SINE
    sine = np.sin(_LATITUDES)[:, None]
    level = (1 + np.sign(sine) * np.abs(sine) ** roundness) / 2  # 0 at the foot, 1 at the top
    width = np.abs(np.cos(_LATITUDES))[:, None] ** roundness * (1 + taper * (level - 0.5))
    points = np.empty((*parameters.shape[:-1], len(_LATITUDES), len(_FACING), 3))
    points[..., 0] = origin[0] + x + width * (np.cos(turn) * along - np.sin(turn) * across)
    points[..., 1] = origin[1] + y + width * (np.sin(turn) * along + np.cos(turn) * across)
    points[..., 2] = np.exp(log_height) * level
    return points.reshape(*parameters.shape[:-1], -1, 3)
