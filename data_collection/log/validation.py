"""Checks of a log against the table of topics; all problems at once."""

import json
from collections.abc import Iterator, Sequence

import numpy as np

from data_collection.joints import JOINT_NAMES
from data_collection.limits import MAX_PIXELS, MAX_SENTENCE, MAX_TRIAL, WORD_RULE, is_word
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError, Message
from data_collection.log.messages import DISTORTION_MODELS, CameraInfo, Floats, JointState
from data_collection.log.numbering import number_of
from data_collection.log.topics import BY_TOPIC, TOPICS, LogKind, Topic
from data_collection.log.truth import truth

MOST_TOLD = 10
"""So many problems of a log are told; the rest is counted."""
_PATTERN = topics.CALIBRATION_PATTERN
_OF_AN_ACTION = {topic.name for topic in TOPICS if topic.required == ("trial",)}
_ONLY_PLACES = (topics.HAND_POSE, topics.CALIBRATION_POSITIONS)
"""Topics of poses of which nothing uses the quaternion."""


def kind_of(log: Log) -> LogKind:
    """Return what kind of log it is: its topics tell, and where an action may be missing or left out, the set."""
    present = {message.topic for message in log.messages}
    if any(name.startswith("/calibration/") for name in present):
        return "calibration"
    set_name = log.metadata.get("set")
    is_told = set_name == "generation" and topics.IMAGE_AFTER not in present
    return "instruction" if is_told or (set_name is None and not present & _OF_AN_ACTION) else "trial"


def told(found: Sequence[str]) -> str:
    """Return problems of a log as text, a line for each; where there are many, the first ones and a count."""
    more = len(found) - MOST_TOLD
    counted = [f"and {more} more problem{'s' if more > 1 else ''} of this file"] if more > 0 else []
    return "\n".join([*found[:MOST_TOLD], *counted])


def problems(log: Log, kind: LogKind | None = None) -> list[str]:
    """Return everything that is wrong with a log, each with file, topic, time and reason; empty when it is sound.

    Args:
        log: Content of a file.
        kind: What it should be; None takes what it looks like.
    """
    kind = kind or kind_of(log)
    present = {message.topic for message in log.messages}
    found = [
        f"{log.source}: {topic.name} is missing ({topic.value.type}, {topic.meaning}); a log of kind {kind} needs it"
        for topic in TOPICS
        if kind in topic.required and topic.name not in present
    ]
    found += [
        f"{log.source}: {name} is not part of a log of kind {kind}"
        for name in sorted(present)
        if kind not in BY_TOPIC[name].required + BY_TOPIC[name].optional
    ]
    for message in log.messages:
        reason = _reason(message, BY_TOPIC[message.topic])
        if reason:
            found.append(f"{log.source}: {message.topic} at {message.time} ns: {reason}")
    found += [f"{log.source}: {reason}" for reason in _size_reasons(log)]
    if kind == "calibration":
        return found + [f"{log.source}: {reason}" for reason in _grid_reasons(log)]
    if number_of(log.source, log.metadata) is None:
        said = f"{log.metadata['trial'][:20]!r}" if "trial" in log.metadata else "missing"
        ways = "or a file that is called trial_0001.mcap" if "trial" not in log.metadata else ""
        found.append(
            f"{log.source}: metadata: trial is {said}, a number from 1 to {MAX_TRIAL:,} is needed {ways}".strip()
        )
    if not any(line.startswith(f"{log.source}: {topics.TRUTH_PREFIX}") for line in found):
        try:
            truth(log)
        except LogError as error:
            found.append(str(error))
    return found


def _size_reasons(log: Log) -> Iterator[str]:
    """Yield what does not fit between the pictures of a log and what it says of the camera, each sound by itself."""
    camera = next((one.value for one in log.messages if isinstance(one.value, CameraInfo)), None)
    if camera is None or _camera_reason(camera):
        return
    for message in log.messages:
        if BY_TOPIC[message.topic].value.type == topics.IMAGE:
            height, width = np.asarray(message.value).shape[:2]
            if (width, height) != (camera.width, camera.height):
                yield (
                    f"{message.topic} has {width} × {height} pixels, but {topics.CAMERA} is for pictures of "
                    f"{camera.width} × {camera.height} (size, region and binning); log the size, K and "
                    "distortion of the pictures as they are (K in proportion where they were made smaller)"
                )


def _grid_reasons(log: Log) -> Iterator[str]:
    """Yield what is wrong between the pattern of a calibration and its positions, each sound by itself."""
    last = {message.topic: message.value for message in log.messages}
    pattern, positions = last.get(topics.CALIBRATION_PATTERN), last.get(topics.CALIBRATION_POSITIONS)
    if isinstance(pattern, str) and isinstance(positions, np.ndarray) and _text_reason(pattern, _PATTERN) is None:
        size = json.loads(pattern)
        if size["rows"] * size["columns"] != len(positions):
            yield (
                f"{topics.CALIBRATION_POSITIONS}: {len(positions)} positions, "
                f"but {topics.CALIBRATION_PATTERN} says {size['rows']} × {size['columns']}"
            )


def _reason(message: Message, topic: Topic) -> str | None:
    """Return what is wrong with a value, or None."""
    value = message.value
    if isinstance(value, JointState):
        return _joint_reason(value) or _range_reason(value.position, topic)
    if isinstance(value, CameraInfo):
        return _camera_reason(value)
    if isinstance(value, str):
        return _text_reason(value, topic.name)
    if isinstance(value, tuple):
        return None  # the transforms are there to be looked at
    numbers = np.asarray(value)
    if topic.value.type == topics.IMAGE:
        return (
            None
            if min(numbers.shape[:2]) >= 32
            else f"image of {numbers.shape[1]} × {numbers.shape[0]} pixels is too small"
        )
    if topic.value.length is not None and numbers.shape[-1:] != (topic.value.length,):
        return f"{numbers.size} values, {topic.value.length} are expected ({topic.value.unit})"
    if topic.name in _ONLY_PLACES:
        numbers = numbers[..., :3]
    if not np.isfinite(numbers).all():
        return "not finite"
    return _range_reason(numbers, topic)


def _range_reason(numbers: Floats, topic: Topic) -> str | None:
    if topic.value.lowest is not None and numbers.min(initial=topic.value.lowest) < topic.value.lowest:
        return f"{numbers.min():g} is below {topic.value.lowest:g} ({topic.value.unit})"
    if topic.value.highest is not None and numbers.max(initial=topic.value.highest) > topic.value.highest:
        return f"{numbers.max():g} is above {topic.value.highest:g} ({topic.value.unit})"
    return None


def _camera_reason(value: CameraInfo) -> str | None:
    if not 1 <= value.width * value.height <= MAX_PIXELS:
        return f"size of {value.width:,} × {value.height:,} must be positive, and at most {MAX_PIXELS:,} pixels"
    if not value.K.any():
        return "K is all zeros, by which drivers say that the camera is not calibrated; calibrate it"
    if not np.isfinite(value.K).all() or min(value.K[0, 0], value.K[1, 1]) <= 0:
        return "focal lengths must be positive, and all of K finite"
    model, sizes = f"distortion model {value.model[:40]!r}", DISTORTION_MODELS.get(value.model)
    if sizes is None or (not value.model and value.D.any()):
        return f"{model} is not supported; {', '.join(filter(None, DISTORTION_MODELS))} are"
    if value.D.size not in sizes or not np.isfinite(value.D).all():
        allowed = " or ".join(map(str, sizes))
        return f"{value.D.size} coefficients of {model}; expected are finite ones, {allowed} of them"
    return None


def _joint_reason(value: JointState) -> str | None:
    if missing := [name for name in JOINT_NAMES if name not in value.names]:
        return f"joints are missing: {', '.join(missing)} (of the {len(JOINT_NAMES)} documented ones)"
    if len(value.position) != len(value.names):
        return f"{len(value.position)} positions for {len(value.names)} joints"
    if value.names != JOINT_NAMES:
        twice = [name for name in JOINT_NAMES if value.names.count(name) > 1]
        return (
            f"joints are there twice: {', '.join(twice)}" if twice else "joints are in another order than documented"
        )
    bad = [name for name, is_good in zip(JOINT_NAMES, np.isfinite(value.position), strict=True) if not is_good]
    return f"positions of joints are not finite: {', '.join(bad)}" if bad else None


def _text_reason(value: str, topic: str) -> str | None:
    if topic == topics.SENTENCE:
        words = value.split()
        bad = [word for word in words if not is_word(word)]
        if bad:
            return f"{bad[0][:60]!r} is no word ({WORD_RULE})"
        return f"{len(words)} words, at most {MAX_SENTENCE} are expected" if len(words) > MAX_SENTENCE else None
    if not (topic.startswith(topics.TRUTH_PREFIX) or topic == _PATTERN):
        return None
    try:
        parsed = json.loads(value)
    except (ValueError, RecursionError) as error:
        return f"no JSON ({error})"
    if topic == _PATTERN and not (
        isinstance(parsed, dict)
        and all(type(parsed.get(key)) is int and 1 < parsed[key] <= 1000 for key in ("rows", "columns"))
    ):
        return 'must be {"rows": r, "columns": c} with whole numbers from 2 to 1000'
    return None
