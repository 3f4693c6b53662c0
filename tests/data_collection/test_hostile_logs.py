"""Logs of strangers: every topic and every field of its messages, broken in every way.

The cases are made from the table of topics, so that a new signal is broken too.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from data_collection.log import topics
from data_collection.log.topics import TOPICS, LogKind, Topic
from data_collection.log.validation import kind_of, problems
from data_collection.log_differences import differences
from tests.data_collection.broken_logs import CASES, kind_with, messages, metadata, refusal, use
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
    ):
        assert " ns" in says


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
