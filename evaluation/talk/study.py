"""The robots of a study as the page asks for them: plain data that become JSON."""

from __future__ import annotations

from base64 import b64encode
from collections import OrderedDict
from collections.abc import AsyncIterator, Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import anyio
from anyio.to_thread import run_sync

from data_collection.log.codec import encode_png
from data_collection.log.trial import observation
from evaluation.talk.acting import reason_not_to_act
from evaluation.talk.questions import ActQuestion, HearQuestion, RobotQuestion, SceneQuestion
from evaluation.talk.queue import Queue, Waiting
from evaluation.talk.robots import Robot, TalkError, choose, load_robot, robots_of
from evaluation.talk.scenes import Scene, SceneName, Scenes
from evaluation.talk.understanding import Understanding, hear, learned_channels
from evaluation.talk.worker import Act, Done, Draw, Failed, Progress
from model import METHODS

MOST_ROBOTS, MOST_SCENES, MOST_LISTED = 16, 64, 200
"""So many robots and scenes are kept in memory, and so many scenes of a test set are offered."""

T = TypeVar("T")
Lines = AsyncIterator[Mapping[str, Any]]


class TalkStudy:
    """A study whose robots are talked to.

    Args:
        results: Its output folder.
        weights: The file of the network's weights, where it used one of its own.

    Raises:
        TalkError: There are no robots.
    """

    def __init__(self, results: Path, weights: Path | None) -> None:
        self._results, self._weights = results, weights
        self.names = robots_of(results)
        self.first = self.names.index(choose(results, self.names, {}))
        self._load = lru_cache(maxsize=MOST_ROBOTS)(self._loaded)
        self._kept: OrderedDict[tuple[str, SceneName], Scene] = OrderedDict()
        self._one = anyio.CapacityLimiter(1)  # what is thought is thought one after the other, too
        robot, scenes = self._load(self.first)
        # What is loaded and compiled at the first sentence, before anybody waits for it.
        scene = self._scene(robot, scenes, SceneName(scenes.numbers(robot)[0]))
        hear(robot, *scenes.features(robot, scene), " ".join(robot.fit.trials.vocabulary[:2]))

    def robots(self) -> dict[str, Any]:
        """Who there is to talk to, and who is met first."""
        listed = [
            {"experiment": name.experiment, "label": name.label, "method": METHODS[name.method].label}
            for name in self.names
        ]
        return {"robots": listed, "first": self.first}

    async def robot(self, question: RobotQuestion) -> dict[str, Any]:
        """The words that a robot knows, each with its channel, and the scenes that there are to talk about."""

        def told() -> dict[str, Any]:
            robot, scenes = self._robot(question.robot)
            return {
                "words": learned_channels(robot.fit),
                "scenes": scenes.numbers(robot)[:MOST_LISTED],
                "draws": scenes.simulation is not None and robot.transforms is not None,
            }

        return await self._thought(told)

    async def hear(self, question: HearQuestion) -> dict[str, Any]:
        """What one or two robots make of a sentence."""

        def told() -> dict[str, Any]:
            asked = [question.robot] if question.other is None else [question.robot, question.other]
            return {"heard": [self._heard(number, question) for number in asked]}

        return await self._thought(told)

    async def scene(self, question: SceneQuestion, queue: Queue) -> Lines:
        """What there is to see in a scene; a new one is drawn when it is its turn."""
        robot, scenes = await self._thought(lambda: self._robot(question.robot))
        if question.drawn and (robot.data, question.scene) not in self._kept:
            async for event in queue.run(Draw(robot.name, question.scene)):
                if isinstance(event, Scene):
                    self._keep(robot, event)
                elif line := _line(event):
                    yield line
                    if "error" in line:
                        return
        yield await self._thought(lambda: self._seen(robot, scenes, question.scene))

    async def act(self, question: ActQuestion, queue: Queue) -> Lines:
        """What a robot does, picture by picture, and what is said of it."""
        robot, scenes = await self._thought(lambda: self._robot(question.robot))
        scene = await self._thought(lambda: self._scene(robot, scenes, question.scene))
        if reason := reason_not_to_act(scenes, robot, scene):
            raise TalkError(reason)
        if not question.sentence.split():
            raise TalkError("nothing was said: say a word that the robot knows")
        async for event in queue.run(Act(robot.name, scene, question.sentence)):
            if line := _line(event):
                yield line

    def _loaded(self, number: int) -> tuple[Robot, Scenes]:
        robot = load_robot(self._results, self.names[number])
        return robot, Scenes(self._results, robot.data, self._weights)

    def _robot(self, number: int) -> tuple[Robot, Scenes]:
        if number >= len(self.names):
            raise TalkError(f"there is no robot {number} (allowed: 0 to {len(self.names) - 1})")
        return self._load(number)

    def _scene(self, robot: Robot, scenes: Scenes, name: SceneName) -> Scene:
        kept = self._kept.get((robot.data, name))
        if kept is None:
            if name.drawn:
                raise TalkError(f"{name} is no longer known: draw it again")
            kept = self._keep(robot, scenes.scene(robot, name))
        return kept

    def _keep(self, robot: Robot, scene: Scene) -> Scene:
        self._kept[robot.data, scene.name] = scene
        while len(self._kept) > MOST_SCENES:
            self._kept.popitem(last=False)
        return scene

    def _seen(self, robot: Robot, scenes: Scenes, name: SceneName) -> dict[str, Any]:
        """A scene as the page draws it: picture and boxes, or places on the table where there is no picture."""
        scene = self._scene(robot, scenes, name)
        table, row = scenes.features(robot, scene)
        image = None if scene.log is None else observation(scene.log).image_before
        boxes = None if scene.percepts is None or image is None else scene.percepts.box.tolist()
        return {
            "name": str(name),
            "image": None if image is None else _picture(encode_png(image)),
            "size": None if image is None else [image.shape[1], image.shape[0]],
            "boxes": boxes,
            "places": table.position[table.trial_index == row].tolist(),
            "said": scene.said or " ".join(table.words[row]),
            "reason": reason_not_to_act(scenes, robot, scene),
        }

    def _heard(self, number: int, question: HearQuestion) -> dict[str, Any]:
        robot, scenes = self._robot(number)
        scene = self._scene(robot, scenes, question.scene)
        understood = hear(robot, *scenes.features(robot, scene), question.sentence)
        return _understanding(understood) | {"label": robot.name.label, "frames": robot.fit.problem.method.has_frames}

    async def _thought(self, told: Callable[[], T]) -> T:
        """What a function tells that takes a while; other requests are answered meanwhile."""
        return await run_sync(told, limiter=self._one)


def _understanding(understood: Understanding) -> dict[str, Any]:
    return {
        "words": [{"text": one.text, "known": one.known, "channels": one.channels} for one in understood.words],
        "objects": understood.objects.tolist(),
        "chosen": list(understood.chosen),
        "categories": [
            {"category": k, "label": label, "probability": float(probability)}
            for k, (label, probability) in enumerate(zip(understood.labels, understood.categories, strict=True))
        ],
        "unknown": list(understood.unknown),
    }


def _line(event: object) -> dict[str, Any]:
    """An event as the page reads it."""
    match event:
        case Waiting(ahead):
            return {"ahead": ahead}
        case Progress(share, png):
            return {"share": share, "image": _picture(png)}
        case Done(attended, tutor, described):
            return {"attended": attended, "tutor": tutor, "described": described}
        case Failed(reason):
            return {"error": reason}
    return {}


def _picture(png: bytes) -> str:
    return f"data:image/png;base64,{b64encode(png).decode()}"
