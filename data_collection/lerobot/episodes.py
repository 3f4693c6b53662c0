"""Episodes: one trial is one episode, one joint message one frame.

The image of a frame is the latest one taken (before, at gaze, after), and the task is the tutor's sentence. A frame
before the first picture shows this, since the first one is of the rest posture; a frame before the first touch and
hand pose is left out. What is not as a reader would expect is told in notes.
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
from data_collection.log.times import joint_times, time_notes
from data_collection.log.trial import observation
from data_collection.log.validation import kind_of

_IMAGES = (topics.IMAGE_BEFORE, topics.IMAGE_GAZE, topics.IMAGE_AFTER)
_TIME = attrgetter("time")


@dataclass(frozen=True)
class Episode:
    """One trial.

    Attributes:
        source: Its log's path.
        task: The sentence.
        times: (F,) seconds from the first of F frames.
        vectors: Each vector (F, n), by feature.
        pictures: The pictures.
        shown: For each frame which of them it shows.
        notes: What is left out or not exact.
    """

    source: str
    task: str
    times: Floats
    vectors: dict[str, Floats]
    pictures: tuple[Image, ...]
    shown: tuple[int, ...]
    notes: tuple[str, ...] = ()


def episodes(logs: Sequence[Path]) -> Iterator[Episode]:
    """Read the trials of logs one after the other; other logs are passed over.

    Raises:
        LogError: A log is damaged or invalid, has no frame, or has several joint states and one time for all.
    """
    for path in logs:
        log = read_log(path)
        if kind_of(log) == "trial":
            yield _episode(log)


def rate_of(episode: Episode) -> float:
    """Return the frames a second, a whole number from 1."""
    steps = np.diff(episode.times)
    middle = float(np.median(steps[steps > 0])) if (steps > 0).any() else 1.0
    return float(max(1, round(1.0 / middle)))


def _episode(log: Log) -> Episode:
    seen = observation(log)
    times = joint_times(log)
    if len(times) > 1 and not np.ptp(times):
        reason = f"all {len(times)} joint states have the time {times[0]} ns, so no rate of frames follows"
        raise LogError(f"{log.source}: {reason} (was the log recorded under simulated time, without a clock?)")
    latest: dict[str, Any] = {}
    pictures: list[Image] = []
    frames: list[tuple[int, Floats, Floats, Floats, int]] = []
    early = left_out = 0
    for time, messages in groupby(sorted(log.messages, key=_TIME), key=_TIME):
        states: list[JointState] = []
        for message in messages:
            latest[message.topic] = message.value
            if isinstance(message.value, JointState) and message.topic == topics.JOINT_STATES:
                states.append(message.value)
            if message.topic in _IMAGES:
                pictures.append(np.asarray(message.value, dtype=np.uint8))
        is_known = {topics.TACTILE, topics.HAND_POSE} <= set(latest)
        early += len(states) if is_known and not pictures else 0
        left_out += 0 if is_known else len(states)
        for joints in states if is_known else ():
            hand: Floats = latest[topics.HAND_POSE][:3]
            frames.append((time, joints.position, latest[topics.TACTILE], hand, max(0, len(pictures) - 1)))
    if not frames:
        raise LogError(f"{log.source}: no joint state after the first touch and hand pose")
    states_ = np.array([frame[1] for frame in frames])
    vectors = {
        "observation.state": states_,
        "observation.tactile": np.array([frame[2] for frame in frames]),
        "observation.hand_position": np.array([frame[3] for frame in frames]),
        "action": np.vstack([states_[1:], states_[-1:]]),
    }
    notes = [f"{log.source}: {note}" for note in (*time_notes(log), *_notes(early, left_out, len(frames)))]
    seconds = np.array([frame[0] - frames[0][0] for frame in frames]) / codec.NANOSECONDS
    task, shown = " ".join(seen.words), tuple(frame[4] for frame in frames)
    return Episode(str(log.source), task, seconds, vectors, tuple(pictures), shown, tuple(notes))


def _notes(early: int, left_out: int, kept: int) -> Iterator[str]:
    total = kept + left_out
    if early:
        yield f"{early} of {total} frames are before the first picture, and show it"
    if left_out:
        yield f"{left_out} of {total} frames are left out: before them neither touch nor hand pose is logged, or one"
