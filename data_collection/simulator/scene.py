"""The physical world: a PyBullet client, the table, what stands on it, and how it looks."""

import contextlib
import logging
import math
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.apparatus import Camera, Light, Table
from data_collection.log.messages import Floats, Image
from data_collection.shapes import Mesh, Shape, build, sheet, wavefront
from data_collection.strict_model import Color
from data_collection.task import Placed

LOGGER = logging.getLogger(__name__)

TIME_STEP = 1.0 / 240.0
_FLOOR = -0.63
_MARK_HEIGHT = 0.0006


@dataclass(frozen=True)
class View:
    """Where a picture is taken from.

    Attributes:
        eye: (3,) position, metres, robot frame.
        ahead: (3,) unit vector of the optical axis.
        up: (3,) unit vector.
        width: Columns.
        height: Rows.
        angle: Vertical angle of view, degrees.
        near: What is nearer than this is not seen, metres.
    """

    eye: Floats
    ahead: Floats
    up: Floats
    width: int
    height: int
    angle: float
    near: float = 0.02


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Send what the C library prints to the debug log instead of to the terminal."""
    sys.stdout.flush()
    saved = [os.dup(1), os.dup(2)]
    with tempfile.TemporaryFile() as capture:
        try:
            os.dup2(capture.fileno(), 1)
            os.dup2(capture.fileno(), 2)
            yield
        finally:
            for number, descriptor in enumerate(saved, start=1):
                os.dup2(descriptor, number)
                os.close(descriptor)
            capture.seek(0)
            text = capture.read().decode(errors="replace").strip()
            if text:
                LOGGER.debug("PyBullet: %s", text)


def connect() -> Any:
    """Return a new client; its methods are PyBullet's functions."""
    with quiet():
        import pybullet
        from pybullet_utils.bullet_client import BulletClient  # type: ignore[import-untyped]

        return BulletClient(connection_mode=pybullet.DIRECT)


def reset(client: Any) -> None:
    """Empty the world and set the solver; two worlds that were reset do the same things to the last bit."""
    client.resetSimulation()
    client.setGravity(0.0, 0.0, -9.81)
    client.setPhysicsEngineParameter(
        fixedTimeStep=TIME_STEP,
        numSolverIterations=60,
        numSubSteps=1,
        deterministicOverlappingPairs=1,
        enableConeFriction=1,
        enableFileCaching=0,
        contactBreakingThreshold=0.002,
    )


def intrinsics(camera: Camera) -> Floats:
    """Return the (3, 3) matrix of the ideal pinhole camera, pixels; the centre of the first pixel is (0, 0).

    The principal point is where PyBullet's renderer has it: it fills rows from the bottom.
    """
    focal = camera.height / 2 / math.tan(math.radians(camera.view) / 2)
    return np.array([[focal, 0.0, camera.width / 2], [0.0, focal, camera.height / 2 - 1], [0.0, 0.0, 1.0]])


def _seen(client: Any, kind: int, color: Sequence[float], **form: Any) -> int:
    """Return a new dull visual shape."""
    return int(client.createVisualShape(kind, rgbaColor=[*color, 1.0], specularColor=[0, 0, 0], **form))


def add_table(client: Any, table: Table) -> int:
    """Add the table's top, its legs and the floor; return the body number of the top."""
    top = [(table.far - table.near) / 2, table.width / 2, 0.01]
    centre = [(table.far + table.near) / 2, 0.0, table.height - 0.01]
    shape = client.createCollisionShape(client.GEOM_BOX, halfExtents=top)
    body: int = client.createMultiBody(
        0.0, shape, _seen(client, client.GEOM_BOX, table.color, halfExtents=top), centre
    )
    client.changeDynamics(body, -1, lateralFriction=0.8, restitution=0.0)
    if table.cloth > 0.0:
        _cover(client, body, weave(table))
    with tempfile.TemporaryDirectory() as folder:
        floor = _visual(client, Path(folder, "floor.obj"), sheet(6.0, 6), (0.45, 0.43, 0.42), 0.0)
        client.createMultiBody(0.0, -1, floor, [0.0, 0.0, _FLOOR])
    depth = (table.height - 0.02 - _FLOOR) / 2
    leg = _seen(client, client.GEOM_BOX, (0.35, 0.33, 0.32), halfExtents=[0.02, 0.02, depth])
    for x in (table.near + 0.03, table.far - 0.03):
        for y in (-table.width / 2 + 0.03, table.width / 2 - 0.03):
            client.createMultiBody(0.0, -1, leg, [x, y, _FLOOR + depth])
    return body


@lru_cache(maxsize=4)
def weave(table: Table) -> Image:
    """Return the cloth's picture (512, 512, 3): crossing threads, blotches and stripes around the table's color."""
    rng = np.random.default_rng(20170001)  # the same cloth in every trial, calibration and process
    row, column = np.mgrid[0:512, 0:512]
    threads = 0.10 * (np.sin(row * (2 * np.pi / 4)) + np.sin(column * (2 * np.pi / 4)))
    coarse = np.kron(rng.normal(size=(32, 32)), np.ones((16, 16))) * 0.10
    fine = rng.normal(size=(512, 512)) * 0.12
    stripes = 0.18 * ((column % 128 < 6) | (row % 128 < 6))
    shade = 1.0 - table.cloth * (0.25 + threads + coarse + fine + stripes)
    picture = 255.0 * np.clip(shade[:, :, None] * np.array(table.color), 0.0, 1.0)
    return np.asarray(np.rint(picture), dtype=np.uint8)


def _cover(client: Any, body: int, picture: Image) -> None:
    """Lay a picture over a body; PyBullet takes textures from files only."""
    import cv2

    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder, "cloth.png"))
        cv2.imwrite(path, picture[:, :, ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 0])
        texture = client.loadTexture(path)
    client.changeVisualShape(body, -1, textureUniqueId=texture, rgbaColor=[1.0, 1.0, 1.0, 1.0])


def add_marks(client: Any, positions: Floats, height: float, radius: float) -> None:
    """Add flat dark dots (N, 2) on the table."""
    dot = _seen(client, client.GEOM_CYLINDER, (0.05, 0.05, 0.05), radius=radius, length=_MARK_HEIGHT)
    for x, y in positions:
        client.createMultiBody(0.0, -1, dot, [x, y, height + _MARK_HEIGHT / 2])


def add_object(client: Any, placed: Placed, color: Color, table_height: float, friction: float) -> int:
    """Put an object on the table; return its body number. Its frame is at half its height."""
    kind = placed.kind
    shape = build(kind.shape, kind.size, kind.height, kind.style)
    middle = shape.height / 2
    more = len(shape.meshes) - 1
    with tempfile.TemporaryDirectory() as folder:
        collision = _collision(client, Path(folder, "hull.obj"), shape)
        visuals = [
            _visual(client, Path(folder, f"{part}.obj"), mesh, color, middle)
            for part, mesh in enumerate(shape.meshes)
        ]
        body: int = client.createMultiBody(
            baseMass=kind.mass,
            baseCollisionShapeIndex=collision,
            baseVisualShapeIndex=visuals[0],
            basePosition=[*placed.position, table_height + middle + 0.0005],
            baseOrientation=client.getQuaternionFromEuler([0.0, 0.0, placed.turn]),
            linkMasses=[1e-5] * more,
            linkCollisionShapeIndices=[-1] * more,
            linkVisualShapeIndices=visuals[1:],
            linkPositions=[[0.0, 0.0, 0.0]] * more,
            linkOrientations=[[0.0, 0.0, 0.0, 1.0]] * more,
            linkInertialFramePositions=[[0.0, 0.0, 0.0]] * more,
            linkInertialFrameOrientations=[[0.0, 0.0, 0.0, 1.0]] * more,
            linkParentIndices=[0] * more,
            linkJointTypes=[client.JOINT_FIXED] * more,
            linkJointAxis=[[0.0, 0.0, 1.0]] * more,
        )
    client.changeDynamics(
        body, -1, lateralFriction=friction, spinningFriction=0.003, rollingFriction=0.002, restitution=0.0,
        linearDamping=0.1, angularDamping=0.3,
    )  # fmt: skip
    return body


def object_pose(client: Any, body: int) -> Floats:
    """Return the pose (7,) of an object: x y z, quaternion x y z w."""
    position, quaternion = client.getBasePositionAndOrientation(body)
    return np.array([*position, *quaternion])


def render(client: Any, view: View, light: Light, direction: Floats, brightness: float) -> Image:
    """Return the picture (H, W, 3), RGB, without the camera's noise."""
    looking = client.computeViewMatrix(list(view.eye), list(view.eye + view.ahead), list(view.up))
    lens = client.computeProjectionMatrixFOV(view.angle, view.width / view.height, view.near, 4.0)
    picture = client.getCameraImage(
        view.width, view.height, looking, lens,
        lightDirection=list(direction), lightColor=[1.0, 1.0, 1.0], lightDistance=2.0, shadow=int(light.shadow),
        lightAmbientCoeff=light.ambient * brightness, lightDiffuseCoeff=light.diffuse * brightness,
        lightSpecularCoeff=0.0, renderer=client.ER_TINY_RENDERER, flags=client.ER_NO_SEGMENTATION_MASK,
    )  # fmt: skip
    pixels = np.asarray(picture[2], dtype=np.uint8).reshape(view.height, view.width, 4)
    return np.ascontiguousarray(pixels[:, :, :3])


# PyBullet never frees the vertices that it is given as lists: meshes are loaded by way of files.


def _collision(client: Any, path: Path, shape: Shape) -> int:
    if shape.collision == "sphere":
        return int(client.createCollisionShape(client.GEOM_SPHERE, radius=shape.height / 2))
    if shape.collision == "box":
        return int(client.createCollisionShape(client.GEOM_BOX, halfExtents=[extent / 2 for extent in shape.extents]))
    points = np.concatenate([mesh.vertices for mesh in shape.meshes]) - np.array([0.0, 0.0, shape.height / 2])
    corners = np.unique(np.round(points, 5), axis=0)
    # PyBullet takes the convex hull of the corners of triangles, whichever; the last is filled up.
    corners = np.concatenate([corners, np.repeat(corners[-1:], -len(corners) % 3, axis=0)])
    path.write_text(wavefront(Mesh(corners, np.zeros_like(corners)), 0.0), encoding="ascii")
    return int(client.createCollisionShape(client.GEOM_MESH, fileName=str(path)))


def _visual(client: Any, path: Path, mesh: Mesh, color: Sequence[float], middle: float) -> int:
    path.write_text(wavefront(mesh, -middle), encoding="ascii")
    return _seen(client, client.GEOM_MESH, [mesh.tone * channel for channel in color], fileName=str(path))
