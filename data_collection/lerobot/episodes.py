"""Episodes: one trial is one episode, one joint message one frame.

The image of a frame is the latest one taken (before, at gaze, after), and the task is the tutor's sentence.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.log import codec, topics
from data_collection.log.mcap_log import Log, LogError, read_log
from data_collection.log.messages import Floats, Image, JointState
from data_collection.log.trial import observation
from data_collection.log.validation import kind_of

_IMAGES = (topics.IMAGE_BEFORE, topics.IMAGE_GAZE, topics.IMAGE_AFTER)
_TIME = attrgetter("time")


@dataclass(frozen=True)
class Episode:
    """One trial, its log's path, each vector (F, n), the pictures, and for each of F frames which one it shows."""

    source: str
    task: str
    times: Floats
    vectors: dict[str, Floats]
    pictures: tuple[Image, ...]
    shown: tuple[int, ...]


def episodes(logs: Sequence[Path]) -> Iterator[Episode]:
    """Read the trials of logs one after the other; other logs are passed over.

    Raises:
        LogError: A log is damaged or invalid, or has no frame.
    """
    for path in logs:
        log = read_log(path)
        if kind_of(log) == "trial":
            yield _episode(log)


def rate_of(episode: Episode) -> float:
    """Return the frames a second, a whole number from 1."""
    times = episode.times
    return float(max(1, round(1.0 / np.median(np.diff(times))))) if len(times) > 1 else 1.0


def _episode(log: Log) -> Episode:
    seen = observation(log)
    latest: dict[str, Any] = {}
    pictures: list[Image] = []
    frames: list[tuple[int, Floats, Floats, Floats, int]] = []
    for time, messages in groupby(sorted(log.messages, key=_TIME), key=_TIME):
        fresh = False
        for message in messages:
            latest[message.topic] = message.value
            fresh |= message.topic == topics.JOINT_STATES
            if message.topic in _IMAGES:
                pictures.append(np.asarray(message.value, dtype=np.uint8))
        if fresh and pictures and {topics.TACTILE, topics.HAND_POSE} <= set(latest):
            joints: JointState = latest[topics.JOINT_STATES]
            hand: Floats = latest[topics.HAND_POSE][:3]
            frames.append((time, joints.position, latest[topics.TACTILE], hand, len(pictures) - 1))
    if not frames:
        raise LogError(f"{log.source}: no joint state after the first image with touch and hand pose")
    states = np.array([frame[1] for frame in frames])
    vectors = {
        "observation.state": states,
        "observation.tactile": np.array([frame[2] for frame in frames]),
        "observation.hand_position": np.array([frame[3] for frame in frames]),
        "action": np.vstack([states[1:], states[-1:]]),
    }
    times = (np.array([frame[0] for frame in frames], dtype=np.float64) - frames[0][0]) / codec.NANOSECONDS
    task, shown = " ".join(seen.words), tuple(frame[4] for frame in frames)
    return Episode(str(log.source), task, times, vectors, tuple(pictures), shown)
