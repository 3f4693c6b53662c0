"""Checks of a log against the table of channels; all problems at once."""

import json

import numpy as np

from data_collection import channels
from data_collection.channels import BY_TOPIC, CHANNELS, JOINT_NAMES, Channel, LogKind
from data_collection.mcap_log import Log, Message
from data_collection.messages import CameraInfo, JointState, Transform


def kind_of(log: Log) -> LogKind:
    """Return what kind of log it is: its topics tell."""
    topics = {message.topic for message in log.messages}
    if any(topic.startswith("/calibration/") for topic in topics):
        return "calibration"
    if log.metadata.get("set") == "generation" and channels.IMAGE_AFTER not in topics:
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
        f"{log.source}: {channel.topic} is missing ({channel.type}, {channel.meaning}); a log of kind {kind} needs it"
        for channel in CHANNELS
        if kind in channel.required and channel.topic not in present
    ]
    for message in log.messages:
        reason = _reason(message, BY_TOPIC[message.topic])
        if reason:
            found.append(f"{log.source}: {message.topic} at {message.time} ns: {reason}")
    if kind != "calibration":
        number = log.metadata.get("trial", "")
        if not number.isdecimal() or int(number) < 1:
            found.append(f"{log.source}: metadata: trial is {number!r}, a number from 1 is needed")
    return found


def _reason(message: Message, channel: Channel) -> str | None:
    """Return what is wrong with a value, or None."""
    value = message.value
    if isinstance(value, JointState):
        return _joint_reason(value)
    if isinstance(value, CameraInfo):
        if (
            value.width < 1
            or value.height < 1
            or not np.isfinite(value.K).all()
            or min(value.K[0, 0], value.K[1, 1]) <= 0
        ):
            return "size and focal lengths must be positive and finite"
        return None
    if isinstance(value, str):
        return _text_reason(value, channel.topic)
    if isinstance(value, tuple):
        bad = [item.child for item in value if isinstance(item, Transform) and not np.isfinite(item.pose).all()]
        return f"transforms of {bad} are not finite" if bad else None
    numbers = np.asarray(value)
    if channel.type == channels.IMAGE:
        return (
            None
            if min(numbers.shape[:2]) >= 32
            else f"image of {numbers.shape[1]} × {numbers.shape[0]} pixels is too small"
        )
    if channel.length is not None and numbers.shape[-1:] != (channel.length,):
        return f"{numbers.size} values, {channel.length} are expected ({channel.unit})"
    if not np.isfinite(numbers).all():
        return "not finite"
    if channel.lowest is not None and numbers.min(initial=channel.lowest) < channel.lowest:
        return f"{numbers.min():g} is below {channel.lowest:g} ({channel.unit})"
    if channel.highest is not None and numbers.max(initial=channel.highest) > channel.highest:
        return f"{numbers.max():g} is above {channel.highest:g} ({channel.unit})"
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
    if not (topic.startswith(channels.TRUTH_PREFIX) or topic == channels.CALIBRATION_PATTERN):
        return None
    try:
        parsed = json.loads(value)
    except ValueError as error:
        return f"no JSON ({error})"
    if topic == channels.CALIBRATION_PATTERN and not (
        isinstance(parsed, dict)
        and all(isinstance(parsed.get(key), int) and parsed[key] > 1 for key in ("rows", "columns"))
    ):
        return 'must be {"rows": r, "columns": c} with whole numbers above 1'
    return None
