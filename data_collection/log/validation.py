"""Checks of a log against the table of topics; all problems at once."""

import json
import re
from collections.abc import Iterator

import numpy as np

from data_collection.joints import JOINT_NAMES
from data_collection.limits import MAX_PIXELS, MAX_SENTENCE, MAX_TRIAL, WORD_RULE, is_word
from data_collection.log import topics
from data_collection.log.mcap_log import Log, Message
from data_collection.log.messages import CameraInfo, Floats, JointState, Transform
from data_collection.log.topics import BY_TOPIC, TOPICS, LogKind, Topic

_PATTERN = topics.CALIBRATION_PATTERN
_DISTORTION_SIZES = (0, 4, 5, 8, 12, 14)
"""What OpenCV takes; the documented number is 5."""


def kind_of(log: Log) -> LogKind:
    """Return what kind of log it is: its topics tell."""
    present = {message.topic for message in log.messages}
    if any(name.startswith("/calibration/") for name in present):
        return "calibration"
    if log.metadata.get("set") == "generation" and topics.IMAGE_AFTER not in present:
        return "instruction"
    return "trial"


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
    if kind == "calibration":
        return found + [f"{log.source}: {reason}" for reason in _grid_reasons(log)]
    number = log.metadata.get("trial", "")
    if not re.fullmatch("[0-9]{1,7}", number) or not 1 <= int(number) <= MAX_TRIAL:
        found.append(f"{log.source}: metadata: trial is {number[:20]!r}, a number from 1 to {MAX_TRIAL:,} is needed")
    return found


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
        bad = [item.child for item in value if isinstance(item, Transform) and not np.isfinite(item.pose).all()]
        return f"transforms of {bad} are not finite" if bad else None
    numbers = np.asarray(value)
    if topic.value.type == topics.IMAGE:
        return (
            None
            if min(numbers.shape[:2]) >= 32
            else f"image of {numbers.shape[1]} × {numbers.shape[0]} pixels is too small"
        )
    if topic.value.length is not None and numbers.shape[-1:] != (topic.value.length,):
        return f"{numbers.size} values, {topic.value.length} are expected ({topic.value.unit})"
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
    if not np.isfinite(value.K).all() or min(value.K[0, 0], value.K[1, 1]) <= 0:
        return "focal lengths must be positive, and all of K finite"
    if value.D.size not in _DISTORTION_SIZES or not np.isfinite(value.D).all():
        return f"{value.D.size} coefficients of distortion; expected are finite ones, {_DISTORTION_SIZES} of them"
    return None


def _joint_reason(value: JointState) -> str | None:
    if value.names != JOINT_NAMES:
        missing = sorted(set(JOINT_NAMES) - set(value.names))
        surplus = sorted(set(value.names) - set(JOINT_NAMES))
        detail = f"missing {missing}, unknown {surplus}" if missing or surplus else "in another order"
        return f"joints are not the {len(JOINT_NAMES)} documented ones ({detail})"
    if value.position.shape != (len(JOINT_NAMES),) or value.velocity.shape not in ((0,), value.position.shape):
        return f"{value.position.size} positions and {value.velocity.size} velocities for {len(JOINT_NAMES)} joints"
    if not (np.isfinite(value.position).all() and np.isfinite(value.velocity).all()):
        return "a joint's position or velocity is not finite"
    return None


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
