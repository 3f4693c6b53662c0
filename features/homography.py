"""From pixels to the table: a homography from calibration marks, and the view that follows from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from data_collection.log.messages import FISHEYE

Array = NDArray[np.float64]

PINHOLE = "plumb_bob"
MARK_ERROR = 3.0
"""Largest root mean square distance, in pixels, of the marks from where the fit puts them."""


class CalibrationError(ValueError):
    """The calibration images do not give a homography; the message says why."""


@dataclass(frozen=True, eq=False)
class Camera:
    """A pinhole camera over the table.

    Attributes:
        projection: float64 (3, 4); maps (x, y, z, 1) to pixels; metres in the robot frame, z above the table.
        matrix: float64 (3, 3), K, in pixels.
        distortion: float64 (n,), OpenCV's coefficients D; empty for none.
        model: Model of distortion, see `DISTORTION_MODELS`.
    """

    projection: Array
    matrix: Array
    distortion: Array
    model: str = PINHOLE

    @property
    def homography(self) -> Array:
        """float64 (3, 3): maps (x, y, 1) on the table to pixels."""
        return self.projection[:, [0, 1, 3]]


def find_marks(image: NDArray[np.uint8], rows: int, columns: int) -> Array:
    """Find a grid of dark dots.

    Args:
        image: uint8 (H, W, 3) RGB.
        rows: Number of rows, one behind the other as the robot sees them.
        columns: Number of dots per row.

    Returns:
        float64 (rows · columns, 2): the centres of the dots in pixels, row by row from far to near, left to right.

    Raises:
        CalibrationError: The grid is not there.
    """
    import cv2

    gray = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    found, dots = cv2.findCirclesGrid(gray, (columns, rows), flags=cv2.CALIB_CB_SYMMETRIC_GRID)
    if not found:
        raise CalibrationError(f"the calibration image does not show {rows} × {columns} dark dots on the table")
    grid = np.asarray(dots, dtype=np.float64).reshape(rows, columns, 2)
    grid = grid[np.argsort(grid[..., 1].mean(axis=1))]  # OpenCV does not say at which corner it starts
    grid = grid[:, np.argsort(grid[..., 0].mean(axis=0))]
    return np.ascontiguousarray(grid.reshape(-1, 2))


def fit_camera(pixels: Array, positions: Array, matrix: Array, distortion: Array, model: str = PINHOLE) -> Camera:
    """Estimate the camera from marks on the table.

    The homography is fitted to the marks alone, by least squares. The table's normal, which the homography
    leaves open, follows from K: the columns of K⁻¹H are the table's axes and origin in the camera's frame
    (Zhang 2000, section 3.1).

    Args:
        pixels: (N, 2), where the image shows the marks, N ≥ 4.
        positions: (N, 2), where they are on the table, metres in the robot frame.
        matrix: (3, 3) K of the camera.
        distortion: D of the camera, may be empty.
        model: Its model of distortion.

    Raises:
        CalibrationError: Too few marks, marks on a line or off the fit, or a camera below the table.
    """
    import cv2

    if len(pixels) < 4 or len(pixels) != len(positions):
        raise CalibrationError(f"{len(pixels)} marks seen of {len(positions)}; expected the same, at least 4")
    spread = np.linalg.svd(positions - positions.mean(axis=0), compute_uv=False)
    if spread[1] < 0.05 * spread[0]:
        raise CalibrationError("the marks lie on a line; expected them spread over the table")
    seen = undistorted(pixels, matrix, distortion, model)
    homography, _ = cv2.findHomography(positions, seen, 0)
    if homography is None:
        raise CalibrationError("no homography fits the marks; expected at least four, no three on a line")
    error = np.sqrt(np.mean(np.sum((_project(homography, positions) - seen) ** 2, axis=1)))
    if not error <= MARK_ERROR:
        raise CalibrationError(f"the marks are off the fit by {error:.2f} pixels; expected {MARK_ERROR} at most")
    axes = np.linalg.solve(matrix, homography)
    axes /= np.sqrt(np.linalg.norm(axes[:, 0]) * np.linalg.norm(axes[:, 1]))
    axes *= np.sign(axes[2] @ [*positions.mean(axis=0), 1.0])  # the marks are in front of the camera
    normal = np.cross(axes[:, 0], axes[:, 1])
    if normal @ axes[:, 2] >= 0:
        raise CalibrationError("the marks show the table from below; expected x ahead, y left, from above")
    projection = matrix @ np.column_stack([axes[:, 0], axes[:, 1], normal, axes[:, 2]])
    return Camera(projection, matrix, distortion, model)


def _project(matrix: Array, points: Array) -> Array:
    """Map points (…, n) to (…, 2) by a matrix (3, n + 1): a homography, or the projection of a camera."""
    mapped = points @ matrix[:, :-1].T + matrix[:, -1]
    return np.asarray(mapped[..., :2] / mapped[..., 2:])


def to_table(camera: Camera, pixels: Array) -> Array:
    """Return the points (N, 2) of the table, metres in the robot frame, that are seen at `pixels` (N, 2)."""
    flat = undistorted(pixels, camera.matrix, camera.distortion, camera.model)
    return _project(np.asarray(np.linalg.inv(camera.homography), dtype=np.float64), flat)


def to_pixels(camera: Camera, points: Array) -> Array:
    """Project points (…, 3), metres in the robot frame, z above the table, to undistorted pixels (…, 2)."""
    return _project(camera.projection, points)


def undistorted(pixels: Array, matrix: Array, distortion: Array, model: str = PINHOLE) -> Array:
    """Remove the lens' distortion from pixels (N, 2): where a pinhole camera of this K shows the same points."""
    if model != FISHEYE and not np.any(distortion):
        return np.asarray(pixels, dtype=np.float64)
    import cv2

    points = np.asarray(pixels, dtype=np.float64).reshape(-1, 1, 2)
    remove = cv2.fisheye.undistortPoints if model == FISHEYE else cv2.undistortPoints
    return np.asarray(remove(points, matrix, distortion, P=matrix)).reshape(-1, 2)
