"""A process that simulates: it draws scenes and carries out what robots have understood, one job after the other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from data_collection.log.codec import encode_png
from evaluation.talk.acting import Deed, Picture, obey
from evaluation.talk.robots import Robot, RobotName, load_robot
from evaluation.talk.scenes import Scene, SceneName, Scenes, extraction_of
from evaluation.talk.understanding import hear
from features.object_feature import fc6


@dataclass(frozen=True)
class Draw:
    """A new scene is to be drawn, for robots that see as this one does."""

    robot: RobotName
    scene: SceneName


@dataclass(frozen=True, eq=False)
class Act:
    """A robot is to do what it is told in a scene."""

    robot: RobotName
    scene: Scene
    sentence: str


Job = Draw | Act


@dataclass(frozen=True)
class Progress:
    """A picture of an action, as PNG, and the share of the action that is done."""

    share: float
    png: bytes


@dataclass(frozen=True)
class Done:
    """What a robot did, see `Deed`."""

    attended: int
    tutor: str | None
    described: dict[str, str]


@dataclass(frozen=True)
class Failed:
    """Why a job cannot be done."""

    reason: str


Event = Progress | Done | Failed | Scene
"""What is sent while a job is done; all but `Progress` end it."""


def work(connection: Connection, results: Path, weights: Path | None, first: RobotName) -> None:
    """Do the jobs that come, until the other end is closed.

    Args:
        connection: Gives jobs, takes events.
        results: The folder of results.
        weights: The file of the network's weights, where the study used one of its own.
        first: The robot that people meet first.
    """
    robot_of = lru_cache(maxsize=4)(lambda name: load_robot(results, name))
    try:
        if not connection.poll(1.0):
            _warm_up(robot_of(first), weights)
        while True:
            job = connection.recv()
            try:
                robot = robot_of(job.robot)
                connection.send(_do(job, robot, Scenes(results, robot.data, weights), connection))
            except ValueError as error:
                connection.send(Failed(str(error)))
    except (EOFError, OSError, KeyboardInterrupt):
        return  # the other end has gone


def _do(job: Job, robot: Robot, scenes: Scenes, connection: Connection) -> Done | Scene:
    if isinstance(job, Draw):
        return scenes.scene(robot, job.scene)

    def show(picture: Picture) -> None:
        connection.send(Progress(picture.share, encode_png(picture.image)))

    understood = hear(robot, *scenes.features(robot, job.scene), job.sentence)
    deed: Deed = obey(scenes, robot, job.scene, understood, show)
    return Done(deed.attended, deed.tutor, dict(deed.described))


def _warm_up(robot: Robot, weights: Path | None) -> None:
    """Load the network while nobody waits for it: the first new scene would take seconds longer."""
    if robot.transforms is None:
        return
    try:
        extraction = extraction_of(robot.transforms, weights)
    except ValueError:
        return  # it is said when a scene is asked for
    fc6(np.zeros((1, 64, 64, 3), dtype=np.uint8), np.ones((1, 64, 64), dtype=np.bool_), extraction)
