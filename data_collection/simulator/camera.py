"""What the lens and the chip add to a rendered picture, and what the robot believes of its camera."""

import numpy as np

from data_collection.apparatus import Camera
from data_collection.log.messages import CameraInfo, Image
from data_collection.log.topics import CAMERA_FRAME
from data_collection.simulator.scene import intrinsics


def expose(rng: np.random.Generator, image: Image, camera: Camera) -> Image:
    """Return `image` with the camera's blur and noise."""
    if camera.blur > 0.0:
        import cv2

        image = np.asarray(cv2.GaussianBlur(image, (0, 0), camera.blur), dtype=np.uint8)
    if camera.noise > 0.0:
        noisy = image + rng.normal(scale=camera.noise, size=image.shape)
        image = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    return image


def believed(rng: np.random.Generator, camera: Camera) -> CameraInfo:
    """Return the camera's parameters as the robot knows them: the true ones, wrong by the calibration's error."""
    matrix = intrinsics(camera)
    errors = rng.normal(scale=1.0, size=4) * camera.calibration_error
    factors = np.ones((3, 3))
    factors[0, 0], factors[1, 1], factors[0, 2], factors[1, 2] = 1.0 + errors
    return CameraInfo(camera.width, camera.height, matrix * factors, np.zeros(5), CAMERA_FRAME)
