"""Scenes drawn with NumPy and OpenCV: a pinhole camera over a table with upright solids, and the truth of it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from data_collection.joints import JOINT_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Log, Message
from data_collection.log.messages import CameraInfo, JointState

WIDTH, HEIGHT = 320, 240
TABLE = np.array([242.0, 242.0, 240.0])


@dataclass(frozen=True)
class Solid:
    """An upright solid: its kind, where it stands (metres), its size, turn (radians) and color (RGB)."""

    kind: str
    x: float
    y: float
    color: tuple[int, int, int] = (200, 30, 30)
    size: float = 0.056
    turn: float = 0.0


class Scene:
    """The camera is 0.35 m above the table, looks down at a point 0.29 m ahead, as the robot's eyes do."""

    def __init__(self) -> None:
        focal = HEIGHT / 2 / np.tan(np.radians(29))
        self.matrix = np.array([[focal, 0, WIDTH / 2 - 0.5], [0, focal, HEIGHT / 2 - 0.5], [0, 0, 1]])
        eye, target = np.array([0.0, 0.03, 0.35]), np.array([0.29, 0.0, 0.0])
        ahead = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(ahead, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        rotation = np.stack([right, np.cross(ahead, right), ahead])
        self.projection = self.matrix @ np.column_stack([rotation, -rotation @ eye])
        grid_x, grid_y = np.meshgrid(np.linspace(0.42, 0.18, 5), np.linspace(0.18, -0.18, 6), indexing="ij")
        self.marks = np.column_stack([grid_x.ravel(), grid_y.ravel()])

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        mapped = points @ self.projection[:, :3].T + self.projection[:, 3]
        return np.asarray(mapped[:, :2] / mapped[:, 2:])

    def on_table(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.project(np.column_stack([points, np.zeros(len(points))]))

    def outline(self, solid: Solid) -> NDArray[np.float64]:
        """Corners of the solid's outline in the image, in pixels."""
        half, angle = solid.size / 2, np.linspace(0, 2 * np.pi, 72, endpoint=False)
        if solid.kind == "ball":
            latitude = np.linspace(-np.pi / 2, np.pi / 2, 37)[:, None]
            ring = half * np.stack([np.cos(latitude) * np.cos(angle), np.cos(latitude) * np.sin(angle),
                                    1 + np.sin(latitude) + 0 * angle], axis=-1).reshape(-1, 3)  # fmt: skip
        else:
            corners = solid.turn + (np.pi / 4 + np.arange(4) * np.pi / 2 if solid.kind == "box" else angle)
            reach = half * (np.sqrt(2) if solid.kind == "box" else 1)
            foot = reach * np.column_stack([np.cos(corners), np.sin(corners)])
            ring = np.vstack([np.column_stack([foot, np.full(len(foot), z)]) for z in (0.0, solid.size)])
        hull = cv2.convexHull(self.project(ring + np.array([solid.x, solid.y, 0.0])).astype(np.float32))
        return np.asarray(hull, dtype=np.float64).reshape(-1, 2)

    def mask(self, solid: Solid) -> NDArray[np.bool_]:
        return self._fill(np.zeros((HEIGHT, WIDTH)), self.outline(solid), 1.0) > 0.5

    def empty(self) -> NDArray[np.uint8]:
        return self.image([])

    def image(
        self, solids: Sequence[Solid], *, noise: float = 0.0, light: float = 1.0, shadow: float = 1.0
    ) -> NDArray[np.uint8]:
        """Draw the solids, lit from the left, with shadows that darken the table to `shadow`."""
        picture = np.broadcast_to(TABLE, (HEIGHT, WIDTH, 3)).copy()
        for solid in solids:
            if shadow < 1:
                area = self._fill(np.zeros((HEIGHT, WIDTH)), self.outline(solid) + np.array([14.0, 4.0]), 1.0)
                picture *= 1 - (1 - shadow) * area[..., None]
        for solid in solids:
            shape = self._fill(np.zeros((HEIGHT, WIDTH)), self.outline(solid), 1.0)[..., None]
            columns = np.arange(WIDTH)[None, :, None]
            shade = np.clip(1 - 0.008 * (columns - self.outline(solid)[:, 0].mean()), 0.6, 1.2)
            picture = picture * (1 - shape) + shape * shade * np.array(solid.color)
        random = np.random.default_rng(len(solids))
        picture = light * picture + noise * random.standard_normal(picture.shape)
        return np.clip(np.rint(picture), 0, 255).astype(np.uint8)

    def marked(self) -> NDArray[np.uint8]:
        """Draw the empty table with dark round marks."""
        picture = self.empty().astype(np.float64)
        angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
        for mark in self.marks:
            disc = self.on_table(mark + 0.008 * np.column_stack([np.cos(angle), np.sin(angle)]))
            shape = self._fill(np.zeros((HEIGHT, WIDTH)), disc, 1.0)[..., None]
            picture = picture * (1 - shape) + 20 * shape
        return picture.astype(np.uint8)

    @staticmethod
    def _fill(canvas: NDArray[np.float64], outline: NDArray[np.float64], value: float) -> NDArray[np.float64]:
        fine = np.zeros((4 * HEIGHT, 4 * WIDTH), dtype=np.uint8)
        cv2.fillPoly(fine, [np.rint(4 * outline + 1.5).astype(np.int32)], 255)
        small = cv2.resize(fine, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
        drawn: NDArray[np.float64] = canvas + value * small.astype(np.float64) / 255
        return drawn


@pytest.fixture(scope="session")
def scene() -> Scene:
    return Scene()


JOINTS = len(JOINT_NAMES)


class Logs:
    """Logs of drawn scenes, as a robot would leave them."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.camera = CameraInfo(WIDTH, HEIGHT, scene.matrix, np.zeros(5), topics.CAMERA_FRAME)

    def calibration(self) -> Log:
        marks = self.scene.marks
        poses = np.column_stack([marks, np.full(len(marks), -0.05), np.zeros((len(marks), 3)), np.ones(len(marks))])
        return Log(
            {"set": "calibration"},
            (
                Message(topics.CAMERA, 0, self.camera),
                Message(topics.CALIBRATION_EMPTY, 0, self.scene.empty()),
                Message(topics.CALIBRATION_MARKS, 0, self.scene.marked()),
                Message(topics.CALIBRATION_POSITIONS, 0, poses),
                Message(topics.CALIBRATION_PATTERN, 0, json.dumps({"rows": 5, "columns": 6})),
            ),
        )

    def trial(self, number: int, solids: Sequence[Solid], attended: int = 0, *, acted: bool = True) -> Log:
        """A trial with these solids; the hand is 1 cm ahead of the attended one and 3 cm above the table."""
        random = np.random.default_rng(number)
        image, one = self.scene.image(solids, noise=1.0), solids[attended]

        def joints(values: NDArray[np.float64]) -> JointState:
            return JointState(JOINT_NAMES, values, np.zeros(0))

        objects = [
            {"object": s.kind, "color": COLOR_WORDS[s.color], "place": "left" if s.y > 0 else "right",
             "position": [s.x, s.y]}
            for s in solids
        ]  # fmt: skip
        messages = [
            Message(topics.IMAGE_BEFORE, 0, image),
            Message(topics.CAMERA, 0, self.camera),
            Message(topics.JOINT_LOWER, 0, joints(np.full(JOINTS, -1.0))),
            Message(topics.JOINT_UPPER, 0, joints(np.full(JOINTS, 1.0))),
            Message(topics.JOINT_STATES, 1, joints(random.uniform(-1, 1, JOINTS))),
            Message(topics.TACTILE, 1, random.uniform(0, 1, 9)),
            Message(topics.HAND_POSE, 1, np.array([one.x + 0.01, one.y, -0.02, 0, 0, 0, 1])),
            Message(topics.SENTENCE, 2, f"touch {COLOR_WORDS[one.color]}" if number % 3 else ""),
            Message(topics.TRUTH_SCENE, 2, json.dumps({"objects": objects, "attended": attended})),
            Message(topics.TRUTH_OUTCOME, 2, json.dumps({"word": "touch"})),
        ]
        if acted:
            messages += [
                Message(topics.IMAGE_GAZE, 1, image),
                Message(topics.IMAGE_AFTER, 1, image),
                Message(topics.FINGER_RATE, 1, float(random.uniform(0, 1))),
                Message(topics.GAZE_TARGET, 1, np.array([one.x, one.y, 0.0])),
            ]
        name = "train" if acted else "generation"
        return Log({"set": name, "trial": str(number)}, tuple(sorted(messages, key=lambda m: m.time)))

    def trials(self, count: int, *, acted: bool = True, first: int = 1) -> list[Log]:
        """Trials with one to three solids at different places."""
        logs = []
        for number in range(first, first + count):
            random = np.random.default_rng([7, number])
            places = random.permutation([[0.21, 0.0], [0.29, 0.14], [0.29, -0.14], [0.38, 0.0]])
            solids = []
            for i in range(random.integers(1, 4)):
                shape = str(random.choice(["box", "cup", "ball"]))
                x, y = places[i] + random.normal(0, 0.01, 2)
                color = list(COLOR_WORDS)[random.integers(3)]
                solids.append(Solid(shape, x, y, color, turn=random.uniform(0, 1.5)))
            logs.append(self.trial(number, solids, int(random.integers(len(solids))), acted=acted))
        return logs


COLOR_WORDS = {(200, 30, 30): "red", (20, 160, 40): "green", (30, 60, 220): "blue"}


@pytest.fixture(scope="session")
def logs(scene: Scene) -> Logs:
    return Logs(scene)
