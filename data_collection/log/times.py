"""What is odd about the times of a log, though its values are sound."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from data_collection.log import topics
from data_collection.log.mcap_log import Log

_UNEVEN = 3.0
"""A step between joint states that is so many times longer than the middle one is a gap."""
_SECOND = 1e9  # nanoseconds


def joint_times(log: Log) -> NDArray[np.uint64]:
    """Return the times of the joint states, nanoseconds, ascending."""
    return np.array([one.time for one in log.messages if one.topic == topics.JOINT_STATES], dtype=np.uint64)


def time_notes(log: Log) -> Iterator[str]:
    """Yield what somebody should know of the times of a log of a trial.

    A study needs only the order of the messages. An animation and an export to a dataset need their times too.
    """
    if len({message.time for message in log.messages}) == 1 < len(log.messages):
        yield (
            f"all messages have the time {log.messages[0].time} ns, so their order in the file counts (was the log "
            "recorded under simulated time, without a clock?)"
        )
        return
    times = joint_times(log)
    if len(times) == 1:
        yield "there is only one joint state"
    steps = np.diff(times)
    if count := int((steps == 0).sum()):
        yield f"{count} joint states have the time of the one before"
    if not (steps > 0).any():
        return
    middle, longest = float(np.median(steps[steps > 0])), float(steps.max())
    if longest > _UNEVEN * middle:
        at = int(steps.argmax())
        yield (
            f"the joint states come every {middle / _SECOND:.3g} s, but after {at + 1} of them none for "
            f"{longest / _SECOND:.3g} s"
        )
    images = (topics.IMAGE_BEFORE, topics.IMAGE_GAZE, topics.IMAGE_AFTER)
    at_ = {one.topic: one.time for one in log.messages if one.topic in images}
    order = [at_[topic] for topic in images if topic in at_]
    if order != sorted(order):
        yield "the pictures are not in the order before, at gaze, after"
