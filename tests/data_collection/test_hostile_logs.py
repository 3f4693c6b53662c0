"""Logs of strangers: every topic and every field of its messages, broken in every way.

The cases are made from the table of topics, so that a new signal is broken too.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from data_collection.joints import JOINT_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Message
from data_collection.log.messages import JointState, Value
from data_collection.log.topics import TOPICS, LogKind, Topic
from data_collection.log.validation import kind_of, problems
from data_collection.log_differences import differences
from tests.data_collection.broken_logs import (
    CASES,
    harmless_values,
    kind_with,
    messages,
    metadata,
    refusal,
    sound,
    use,
)
from tests.data_collection.raw_mcap import (
    Raw,
    log_file,
)


@pytest.mark.parametrize("kind", ["trial", "instruction", "calibration"])
def test_the_logs_that_are_broken_below_are_sound(tmp_path: Path, kind: LogKind) -> None:
    (tmp_path / "a.mcap").write_bytes(log_file(messages(kind), metadata(kind)))
    log = use(tmp_path / "a.mcap")
    assert (kind_of(log), problems(log)) == (kind, [])


def test_every_topic_is_broken_somehow() -> None:
    assert {case.values[0] for case in CASES} == set(TOPICS)


@pytest.mark.bad_input
@pytest.mark.parametrize(("topic", "change"), CASES)
def test_a_bad_message_is_refused(shared_folder: Path, topic: Topic, change: Callable[[Raw], list[Raw]]) -> None:
    kind = kind_with(topic)
    changed = [one for raw in messages(kind) for one in (change(raw) if raw.topic == topic.name else [raw])]
    says = refusal(shared_folder, log_file(changed, metadata(kind)))
    assert topic.name in says
    if (
        "missing" not in says
        and "as documented" not in says
        and "attended is" not in says
        and "positions, but" not in says
        and "is for pictures of" not in says
    ):
        assert " ns" in says


HARMLESS = [(topic, label, value) for topic in TOPICS for label, value in harmless_values(topic)]


@pytest.mark.parametrize(("topic", "label", "value"), HARMLESS, ids=[f"{one[0].name}-{one[1]}" for one in HARMLESS])
def test_what_nothing_uses_may_be_anything(shared_folder: Path, topic: Topic, label: str, value: Value) -> None:
    kind = kind_with(topic)
    changed = [
        Raw.of(Message(raw.topic, raw.time, value)) if raw.topic == topic.name else raw for raw in messages(kind)
    ]
    (shared_folder / "a.mcap").write_bytes(log_file(changed, metadata(kind)))
    log = use(shared_folder / "a.mcap")
    assert problems(log) == []
    if isinstance(value, JointState):
        read = next(message.value for message in log.messages if message.topic == topic.name)
        assert isinstance(read, JointState)
        assert read.names == JOINT_NAMES
        assert not read.position.any()


@pytest.mark.parametrize("topic", [topic for topic in TOPICS if topic.once], ids=str)
def test_the_same_again_is_there_once(shared_folder: Path, topic: Topic) -> None:
    """As a recorder hears it that runs beside a publisher who repeats himself."""
    kind = kind_with(topic)
    again = next(raw for raw in messages(kind) if raw.topic == topic.name)
    if topic.value.type != topics.IMAGE:  # of pictures the bytes are compared, and these hold the time
        again = Raw.of(Message(topic.name, again.time + 10**9, sound(topic)))
    (shared_folder / "a.mcap").write_bytes(log_file([*messages(kind), again], metadata(kind)))
    log = use(shared_folder / "a.mcap")
    assert [message.topic for message in log.messages].count(topic.name) == 1


@pytest.mark.bad_input
@pytest.mark.parametrize(("kind", "topic"), [(kind, topic.name) for topic in TOPICS for kind in topic.required])
def test_a_missing_topic_is_refused(tmp_path: Path, kind: LogKind, topic: str) -> None:
    kept = [raw for raw in messages(kind) if raw.topic != topic]
    data = metadata(kind) | ({"set": "train"} if topic == topics.IMAGE_AFTER else {})
    says = refusal(tmp_path, log_file(kept, data))
    assert f"{topic} is missing" in says or kind == "calibration"


@pytest.mark.parametrize(("kind", "topic"), [(kind, topic.name) for topic in TOPICS for kind in topic.optional])
def test_an_optional_topic_may_be_missing(tmp_path: Path, kind: LogKind, topic: str) -> None:
    kept = [raw for raw in messages(kind) if raw.topic != topic and not raw.topic.startswith(topics.TRUTH_PREFIX)]
    (tmp_path / "a.mcap").write_bytes(log_file(kept, metadata(kind)))
    assert topic not in {message.topic for message in use(tmp_path / "a.mcap").messages}


@pytest.mark.parametrize("kind", ["trial", "instruction", "calibration"])
def test_order_in_the_file_and_unknown_topics_make_no_difference(tmp_path: Path, kind: LogKind) -> None:
    (tmp_path / "a.mcap").write_bytes(log_file(messages(kind), metadata(kind)))
    foreign = Raw("/diagnostics", 5, b"anything", "foreign/msg/Thing", "json", "jsonschema")
    (tmp_path / "b.mcap").write_bytes(log_file([foreign, *messages(kind)[::-1]], metadata(kind)))
    assert differences(use(tmp_path / "a.mcap"), use(tmp_path / "b.mcap")) == []


TRIALS = ("", "0", "-1", "one", "1.5", "1e3", "٣", "²", " 1", "1\n", "1000001", "9" * 5000, "0x1", "../1", "1;ls")


@pytest.mark.bad_input
@pytest.mark.parametrize("number", TRIALS)
def test_a_bad_trial_number_is_refused(tmp_path: Path, number: str) -> None:
    says = refusal(tmp_path, log_file(messages("trial"), {"trial": number}))
    assert "metadata: trial is" in says
    assert len(says) < 300


@pytest.mark.parametrize("topic", [topics.GAZE_TARGET, topics.FINGER_RATE, topics.CALIBRATION_PATTERN])
def test_a_topic_of_another_kind_of_log_is_refused(tmp_path: Path, topic: str) -> None:
    """In the log of an instruction nothing is done yet."""
    other = next(raw for kind in ("trial", "calibration") for raw in messages(kind) if raw.topic == topic)
    told = refusal(tmp_path, log_file((*messages("instruction"), other), metadata("instruction")))
    kind = "calibration" if topic == topics.CALIBRATION_PATTERN else "instruction"
    assert f"of kind {kind}" in told
