"""A robot does what it has understood, or something of its own accord, and says what it did."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Any

from data_collection.episode import execute
from data_collection.log.mcap_log import Log
from data_collection.log.messages import Image
from data_collection.log.trial import observation
from data_collection.log.truth import truth
from data_collection.outside import Outside
from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation
from data_collection.simulator.recording import Sample
from evaluation.acting import commands
from evaluation.description import spoken_of
from evaluation.talk.robots import Robot, TalkError
from evaluation.talk.scenes import Scene, Scenes
from evaluation.talk.understanding import Understanding
from features.percepts import with_action
from features.transforms import apply

WIDTH, HEIGHT, PICTURES = 360, 270, 14
"""Of a clip: columns and rows of its pictures, pixels, and about how many there are."""
NANOSECONDS = 1e9


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture of an action while it goes on: the share of the action that is done, and the robot from outside."""

    share: float
    image: Image


@dataclass(frozen=True, eq=False)
class Deed:
    """What a robot did.

    Attributes:
        attended: Index of the object that it acted on.
        tutor: The tutor's word for the action; None where nobody saw it.
        outcome: What physically happened, see `data_collection.log.truth.Truth`.
        described: What the robot says that it did, by channel, in the order in which it says it.
        heard: What the tutor said; of an action that was asked for, the tutor's instruction for the scene.
        log: What was recorded.
    """

    attended: int
    tutor: str | None
    outcome: Mapping[str, Any]
    described: Mapping[str, str]
    heard: str
    log: Log


def reason_not_to_act(scenes: Scenes, robot: Robot, scene: Scene) -> str:
    """Why a robot cannot act in a scene; empty if it can."""
    if scenes.simulation is None or robot.transforms is None or scene.percepts is None:
        return f"{scenes.data}: its features do not come from a simulation, so the robot understands but cannot act"
    if scene.log is None:
        return f"{scene.name}: its log is not in {scenes.results}, so the robot understands but cannot act"
    if scene.log.metadata["set"] != "generation":
        return f"{scene.name} is one that it learned from, and no test set is there: draw a new scene to act in"
    return ""


def obey(
    scenes: Scenes,
    robot: Robot,
    scene: Scene,
    understood: Understanding,
    show: Callable[[Picture], None] | None = None,
) -> Deed:
    """Carry out in the simulation what a robot has understood.

    Of tied choices one is drawn, the same each time that the same robot is told the same in the same scene.

    Args:
        scenes: Where the scene is from.
        robot: Who acts.
        scene: Where.
        understood: What it was told, and makes of it.
        show: Is shown pictures while the robot acts.

    Raises:
        TalkError: It cannot act; the message says why.
    """
    reason = reason_not_to_act(scenes, robot, scene)
    simulation, transforms = scenes.simulation, robot.transforms
    if reason or simulation is None or transforms is None or scene.percepts is None or scene.log is None:
        raise TalkError(reason)
    names = [str(value) for value in vars(robot.name).values()]
    rng = generator(scenes.seed, "tell", *names, scene.name.trial, understood.sentence)
    table = apply(transforms, scene.percepts)
    told = commands(rng, robot.fit, transforms, table, [understood.answer], scene.percepts.hand)

    with ExitStack() as closing:
        watch = None
        if show is not None:
            outside = closing.enter_context(Outside(scene.log, WIDTH, HEIGHT))
            watch = _watcher(simulation, told[0].target is not None, outside, show)
        where: Any = {"experiment": scenes.data, "seed": scenes.seed, "provenance": {}}
        (log,) = execute(simulation, commands=told, watch=watch, **where)
    return _deed(robot, scene, log)


def on_its_own(robot: Robot, scene: Scene) -> Deed:
    """What a robot did of its own accord in a scene of the set `description`.

    Raises:
        TalkError: Nothing was recorded of it.
    """
    if scene.log is None or scene.percepts is None or robot.transforms is None:
        raise TalkError(f"{scene.name}: there is no record of what the robot did")
    return _deed(robot, scene, scene.log)


def _deed(robot: Robot, scene: Scene, log: Log) -> Deed:
    if scene.percepts is None or robot.transforms is None:
        raise TalkError(f"{scene.name}: what was seen of it is not known")
    seen, happened = observation(log), truth(log)
    table = apply(robot.transforms, with_action(scene.percepts, seen))
    return Deed(
        attended=int(table.attended_object[0]),
        tutor=None if happened is None else happened.action_word,
        outcome={} if happened is None else happened.outcome,
        described={channel: said for channel, (said,) in spoken_of(robot.fit, table).items()},
        heard=" ".join(seen.words),
        log=log,
    )


def _watcher(
    simulation: Simulation, moves: bool, outside: Outside, show: Callable[[Picture], None]
) -> Callable[[Sample], None]:
    """What makes pictures of the samples of an action, evenly spaced."""
    motion = simulation.motion
    seconds = motion.gaze_time + 0.1 + motion.bend_time + moves * (motion.transfer_time + motion.descent_time)
    every = max(1, math.ceil(seconds * motion.log_rate / PICTURES))
    count = 0

    def watch(sample: Sample) -> None:
        nonlocal count
        share = min(sample.time / NANOSECONDS / seconds, 1.0)
        if count % every == 0 or share == 1.0:
            show(Picture(share, outside.picture(sample.position, sample.objects)))
        count += 1

    return watch
