"""The view that a calibration log gives: the empty table and the camera."""

from __future__ import annotations

from dataclasses import dataclass

from data_collection.log.trial import Calibration
from features.detection import Image
from features.homography import Camera, find_marks, fit_camera


@dataclass(frozen=True, eq=False)
class View:
    """The robot's view of its table, the same for all trials of an experiment.

    Attributes:
        empty: uint8 (H, W, 3) RGB, the table without objects.
        camera: From pixels to the table and back.
        table_height: Height of the table (z), metres, robot frame.
    """

    empty: Image
    camera: Camera
    table_height: float


def fit_view(calibration: Calibration) -> View:
    """Find the marks in the calibration image, and fit the camera to them.

    Raises:
        CalibrationError: The marks are not found, or do not fit.
    """
    marks = find_marks(calibration.image_marks, calibration.mark_rows, calibration.mark_columns)
    camera = calibration.camera
    fitted = fit_camera(marks, calibration.mark_positions, camera.K, camera.D, camera.model)
    return View(calibration.image_empty, fitted, calibration.table_height)
