"""Sound logs of every kind, and every way to break a message of theirs, made from the table of topics."""

from __future__ import annotations

import dataclasses
import functools
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from data_collection.joints import JOINT_NAMES
from data_collection.limits import MAX_MESSAGE_BYTES, MAX_SENTENCE
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError, Message, read_log
from data_collection.log.messages import CameraInfo, JointState, Transform, Value
from data_collection.log.topics import TOPICS, LogKind, Topic
from data_collection.log.trial import calibration, observation
from data_collection.log.truth import truth
from data_collection.log.validation import kind_of
from tests.data_collection.raw_mcap import (
    Raw,
)

NAN, INF = float("nan"), float("inf")
TIME = 1_000_000_007
SCENE: dict[str, Any] = {
    "attended": 0,
    "objects": [{"object": "cup", "color": "red", "place": "left", "position": [0.3, 0.1]}],
}
TEXTS = {
    topics.SENTENCE: "grasp red cup",
    topics.ROBOT_DESCRIPTION: "<robot/>",
    topics.TRUTH_SCENE: json.dumps(SCENE),
    topics.TRUTH_OUTCOME: json.dumps({"word": "grasp", "action": "grasp"}),
    topics.CALIBRATION_PATTERN: json.dumps({"rows": 2, "columns": 2}),
}
POSES = np.tile([0.3, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0], (4, 1))


def sound(topic: Topic) -> Value:
    """A value that a topic accepts."""
    made: dict[str, Callable[[], Value]] = {
        topics.IMAGE: lambda: np.arange(32 * 40 * 3).astype(np.uint8).reshape(32, 40, 3),
        topics.CAMERA_INFO: lambda: CameraInfo(40, 32, np.diag([50.0, 51.0, 1.0]), np.zeros(5), "eye"),
        topics.JOINT_STATE: lambda: JointState(JOINT_NAMES, np.zeros(25), np.zeros(25)),
        topics.NUMBER: lambda: 0.5,
        topics.NUMBERS: lambda: np.full(topic.value.length or 0, 0.5),
        topics.POINT: lambda: POSES[0, :3],
        topics.POSE: lambda: POSES[0],
        topics.POSES: lambda: POSES,
        topics.TRANSFORMS: lambda: (Transform("root", "hand", POSES[0]),),
        topics.TEXT: lambda: TEXTS[topic.name],
    }
    return made[topic.value.type]()


def another(topic: Topic) -> Value:
    """A sound value that differs from `sound`."""
    value = sound(topic)
    if isinstance(value, str):
        return f"{value} "
    if isinstance(value, CameraInfo):
        return dataclasses.replace(value, K=2 * value.K)
    if isinstance(value, JointState):
        return dataclasses.replace(value, position=value.position + 0.1)
    assert isinstance(value, float | np.ndarray)
    return 255 - value if topic.value.type == topics.IMAGE else value / 2


@functools.cache
def messages(kind: LogKind) -> tuple[Raw, ...]:
    """A sound log of a kind, with all that it may hold."""
    held = [topic for topic in TOPICS if kind in topic.required + topic.optional]
    return tuple(Raw.of(Message(topic.name, TIME + i, sound(topic))) for i, topic in enumerate(held))


def metadata(kind: LogKind) -> dict[str, str]:
    return {"trial": "1", "set": "generation" if kind == "instruction" else "train"}


def kind_with(topic: Topic) -> LogKind:
    return (topic.required + topic.optional)[0]


def use(path: Path) -> Log:
    """Read a log as the study does, to the last field."""
    log = read_log(path)
    if kind_of(log) == "calibration":
        calibration(log)
    else:
        observation(log)
        truth(log)
    return log


Broken = tuple[str, Callable[[Raw], list[Raw]]]


def wrong_envelopes(topic: Topic) -> Iterator[Broken]:
    """What can be wrong with any message, whatever it holds."""

    def changed(**change: Any) -> Callable[[Raw], list[Raw]]:
        return lambda raw: [dataclasses.replace(raw, **change)]

    def cut(part: float) -> Callable[[Raw], list[Raw]]:
        return lambda raw: [dataclasses.replace(raw, data=raw.data[: int(part * len(raw.data))])]

    others = sorted({other.value.type for other in TOPICS} - {topic.value.type})
    for other in (*others, "std_msgs/msg/Nonsense", ""):
        yield f"type {other}", changed(type=other)
    for encoding in ("json", "ros1", "protobuf", ""):
        yield f"encoding {encoding!r}", changed(encoding=encoding)
        yield f"schema encoding {encoding!r}", changed(schema_encoding=encoding)
    yield "no bytes", changed(data=b"")
    yield "half the bytes", cut(0.5)
    yield "four bytes", changed(data=b"\0\1\0\0")
    yield (
        "lengths of 4 GiB",
        lambda raw: [dataclasses.replace(raw, data=raw.data[:4] + b"\xff" * (len(raw.data) - 4))],
    )
    if topic.value.type != topics.IMAGE:
        yield "too many bytes", changed(data=bytes(MAX_MESSAGE_BYTES + 1))
    if topic.once:
        yield "twice", lambda raw: [raw, Raw.of(Message(raw.topic, raw.time + 1, another(topic)))]


def wrong_values(topic: Topic) -> Iterator[tuple[str, Value]]:
    """Every field of a value, broken in every way that it can be written."""
    value = sound(topic)
    if topic.value.type == topics.IMAGE:
        yield "8 × 8 pixels", np.zeros((8, 8, 3), np.uint8)
        yield "one row", np.zeros((1, 400, 3), np.uint8)
    elif topic.value.type == topics.TEXT:
        yield from wrong_texts(topic)
    elif isinstance(value, CameraInfo):
        for change in ({"width": 0}, {"height": 0}, {"width": 100_000, "height": 100_000}):
            yield f"size {change}", dataclasses.replace(value, **change)
        for at in np.ndindex(3, 3):
            for bad in (NAN, INF, -INF):
                yield f"K{list(at)} {bad}", dataclasses.replace(value, K=put(value.K, at, bad))
        for at in ((0, 0), (1, 1)):
            for bad in (0.0, -1.0):
                yield f"K{list(at)} {bad}", dataclasses.replace(value, K=put(value.K, at, bad))
        for index in range(5):
            for bad in (NAN, INF, -INF):
                yield f"D[{index}] {bad}", dataclasses.replace(value, D=put(value.D, index, bad))
        for size in (1, 6, 1000):
            yield f"D of {size}", dataclasses.replace(value, D=np.zeros(size))
        for size in (0, 5):
            yield f"equidistant D of {size}", dataclasses.replace(value, D=np.zeros(size), model="equidistant")
        for model in ("fov", "Plumb_Bob", "x" * 1000):
            yield f"model {model:.9}", dataclasses.replace(value, model=model)
        yield "no model, but D", dataclasses.replace(value, D=np.full(5, 0.1), model="")
        yield "K of zeros", dataclasses.replace(value, K=np.zeros((3, 3)))
        for change in ({"width": 80, "height": 64}, {"width": 32, "height": 40}):
            yield f"another size than the picture {change}", dataclasses.replace(value, **change)
    elif isinstance(value, JointState):
        yield from wrong_joints(value)
    elif not isinstance(value, tuple):
        numbers = np.asarray(value, dtype=np.float64)
        used = (at for at in np.ndindex(numbers.shape) if topic.name not in ONLY_PLACES or at[-1] < 3)
        for at in (at for at in used if topic.value.type != topics.POSES or at[0] == 1):
            for bad in (NAN, INF, -INF, (topic.value.lowest or 0) - 1e-6, (topic.value.highest or 0) + 1e-6):
                yield f"{list(at)} {bad}", put(numbers, at, bad)
        if topic.value.type == topics.NUMBERS:
            for size in (0, topic.value.length - 1, topic.value.length + 1, 100_000):
                yield f"{size} numbers", np.zeros(size)


ONLY_PLACES = (topics.HAND_POSE, topics.CALIBRATION_POSITIONS)


def harmless_values(topic: Topic) -> Iterator[tuple[str, Value]]:
    """Values as robots publish them, which say what is needed: the rest is passed over."""
    value = sound(topic)
    if isinstance(value, tuple):
        for bad in (NAN, INF, -INF):
            yield f"pose {bad}", (Transform("root", "hand", np.full(7, bad)),)
    elif topic.name in ONLY_PLACES:
        for bad in (NAN, INF, 0.0, 11.0):
            yield f"turn {bad}", put(value, (..., slice(3, None)), bad)
    elif isinstance(value, JointState):
        for bad in (NAN, -INF):
            yield f"moves {bad}", dataclasses.replace(value, velocity=put(value.velocity, 3, bad))
        for size in (0, 1, 24, 26, 10_000):
            yield f"{size} velocities", dataclasses.replace(value, velocity=np.zeros(size))
        yield "another order", dataclasses.replace(value, names=JOINT_NAMES[::-1])
        more = (*JOINT_NAMES[:9], "left_wheel", *JOINT_NAMES[9:])
        yield "a joint more", JointState(more, put(np.zeros(26), 9, NAN), np.zeros(26))


def wrong_joints(value: JointState) -> Iterator[tuple[str, Value]]:
    for j, name in enumerate(JOINT_NAMES):
        yield f"{name} unknown", dataclasses.replace(value, names=(*JOINT_NAMES[:j], "tail", *JOINT_NAMES[j + 1 :]))
        for bad in (NAN, INF, 90.0):
            yield f"{name} at {bad}", dataclasses.replace(value, position=put(value.position, j, bad))
    yield "a name missing", dataclasses.replace(value, names=JOINT_NAMES[:-1])
    yield "a name twice", dataclasses.replace(value, names=(*JOINT_NAMES, JOINT_NAMES[0]))
    for size in (0, 24, 26, 10_000):
        yield f"{size} positions", dataclasses.replace(value, position=np.zeros(size))
    yield (
        "a name twice, as often as there are positions",
        JointState((*JOINT_NAMES, JOINT_NAMES[0]), np.zeros(26), np.zeros(26)),
    )
    yield "no names", dataclasses.replace(value, names=())


BAD_WORDS = (
    "/grasp", "x" * 41, "=1+1", "+1", "-1", "@cmd", "a\0b", "\x1b[31m", "a\u200bb", "\u202eb", "a\ufeff", "NA", "12",
)  # fmt: skip


def wrong_texts(topic: Topic) -> Iterator[tuple[str, Value]]:
    if topic.name == topics.SENTENCE:
        for word in BAD_WORDS:
            yield f"word {word[:9]!r}", f"grasp {word}"
        yield "many words", "red " * (MAX_SENTENCE + 1)
        return
    if topic.name == topics.ROBOT_DESCRIPTION:
        return
    yield from {"empty": "", "half": "{", "deep": "[" * 100_000, "no mapping": "3", "null": "null"}.items()
    valid: dict[str, Any] = json.loads(TEXTS[topic.name])
    bad: Any
    if topic.name == topics.CALIBRATION_PATTERN:
        for key in valid:
            for bad in (None, "2", 2.0, True, [2], 0, -2, 1, 3, 1001, 10**30, NAN, INF):
                yield f"{key} {bad!r}", json.dumps(valid | {key: bad})
            yield f"no {key}", json.dumps({other: valid[other] for other in valid if other != key})
    elif topic.name == topics.TRUTH_OUTCOME:
        for bad in (None, 3, ["grasp"], "", "two words", *BAD_WORDS):
            yield f"word {bad!r}", json.dumps({"word": bad})
        yield "no word", "{}"
    else:
        for bad in (None, "0", 0.5, [0], -1, 1, 10**30, NAN, INF):
            yield f"attended {bad!r}", json.dumps(valid | {"attended": bad})
        for bad in (None, 3, "text", {}, [], [3], [None]):
            yield f"objects {bad!r}", json.dumps(valid | {"objects": bad})
        for key in valid:
            yield f"no {key}", json.dumps({other: valid[other] for other in valid if other != key})
        only = valid["objects"][0]
        for key in only:
            yield (
                f"objects[0] without {key}",
                json.dumps(valid | {"objects": [{other: only[other] for other in only if other != key}]}),
            )
            wrong = (None, 3, "x", [0.3], [0.3, 0.1, 0.0], [0.3, NAN], [INF, 0.1], [[0.3], 0.1], ["a", "b"])
            for bad in wrong if key == "position" else (None, 3, ["cup"], "", "two words", *BAD_WORDS):
                yield f"objects[0].{key} {bad!r}", json.dumps(valid | {"objects": [only | {key: bad}]})


def put(values: Any, at: Any, value: float) -> Any:
    """A copy with one number replaced; a number by itself is replaced whole."""
    changed = np.array(values, dtype=np.float64)
    changed[at] = value
    return float(changed) if changed.ndim == 0 else changed


def cases() -> Iterator[Any]:
    for topic in TOPICS:
        for label, change in wrong_envelopes(topic):
            yield pytest.param(topic, change, id=f"{topic.name}-{label}")
        for label, value in wrong_values(topic):

            def remade(raw: Raw, value: Value = value) -> list[Raw]:
                return [Raw.of(Message(raw.topic, raw.time, value))]

            yield pytest.param(topic, remade, id=f"{topic.name}-{label!s:.60}")


CASES = list(cases())


def refusal(folder: Path, content: bytes) -> str:
    """The error that a file is refused by; it names the file."""
    path = folder / "trial_0007.mcap"
    path.write_bytes(content)
    with pytest.raises(LogError) as caught:
        use(path)
    assert str(path) in str(caught.value)
    return str(caught.value)
