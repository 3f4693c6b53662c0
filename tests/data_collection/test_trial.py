import dataclasses
import json
from collections.abc import Callable

import numpy as np
import pytest

from data_collection.joints import JOINT_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError, Message
from data_collection.log.messages import CameraInfo, JointState, Value, same
from data_collection.log.topics import TOPICS, TRUTH_PREFIX, LogKind
from data_collection.log.trial import calibration, observation
from data_collection.log.truth import truth
from data_collection.log.validation import problems


def _without(log: Log, prefix: str) -> Log:
    kept = tuple(message for message in log.messages if not message.topic.startswith(prefix))
    return dataclasses.replace(log, messages=kept, source="trial_0001.mcap")


def _with(log: Log, topic: str, change: Callable[[Value], Value]) -> Log:
    """Return the log with the last value on a topic changed."""
    last = max(index for index, message in enumerate(log.messages) if message.topic == topic)
    messages = list(log.messages)
    messages[last] = Message(topic, messages[last].time, change(messages[last].value))
    return dataclasses.replace(log, messages=tuple(messages), source="trial_0001.mcap")


def test_observation(trials: list[Log]) -> None:
    for number, log in enumerate(trials, start=1):
        seen = observation(log)
        assert seen.trial == number
        assert seen.image_after is not None
        assert seen.image_before.shape == seen.image_after.shape == (300, 400, 3)
        assert seen.joint_names == JOINT_NAMES
        assert (seen.joint_lower < seen.joint_upper).all()
        assert (seen.joint_positions >= seen.joint_lower - 0.02).all()
        assert (seen.joint_positions <= seen.joint_upper + 0.02).all()
        assert len(seen.words) == 4
        known = truth(log)
        assert known is not None
        assert seen.gaze_target is not None
        attended = known.positions[known.attended]
        assert np.linalg.norm(seen.gaze_target - attended) < 0.02
        assert known.action_word in seen.words
        assert known.object_words[known.attended] in seen.words
        assert known.color_words[known.attended] in seen.words
        assert known.place_words[known.attended] in seen.words


def test_words_are_read_in_one_normal_form(trials: list[Log]) -> None:
    """An é of two code points, as some keyboards type it, is the é of one."""
    log = _with(trials[0], topics.SENTENCE, lambda value: "tasse\u0301 a\u0300")
    assert observation(log).words == ("tass\u00e9", "\u00e0")
    log = _with(log, topics.TRUTH_OUTCOME, lambda value: json.dumps(json.loads(str(value)) | {"word": "e\u0301"}))
    known = truth(log)
    assert known is not None
    assert known.action_word == "\u00e9"


def test_observation_needs_no_truth(trials: list[Log], instruction: Log) -> None:
    for log in (*trials, instruction):
        bare = _without(log, TRUTH_PREFIX)
        assert truth(bare) is None
        assert same(observation(bare), observation(log))


@pytest.mark.bad_input
@pytest.mark.parametrize("attempts", [0, -1, 1.5, "two", None, 10**9])
def test_attempts_that_are_no_number_are_an_error(trials: list[Log], attempts: object) -> None:
    def told(value: Value) -> str:
        return json.dumps(json.loads(str(value)) | {"attempts": attempts})

    with pytest.raises(LogError, match=r"trial_0001\.mcap: .*not as documented"):
        truth(_with(trials[0], topics.TRUTH_OUTCOME, told))


def test_half_the_truth_is_an_error(trials: list[Log]) -> None:
    with pytest.raises(LogError, match=f"{topics.TRUTH_OUTCOME} is missing"):
        truth(_without(trials[0], topics.TRUTH_OUTCOME))


def test_instruction(instruction: Log) -> None:
    seen, known = observation(instruction), truth(instruction)
    assert known is not None
    assert seen.image_gaze is None
    assert seen.image_after is None
    assert seen.gaze_target is None
    assert known.action_word in seen.words
    assert np.array_equal(seen.tactile, np.zeros(9))


def test_calibration(calibration_log: Log) -> None:
    found = calibration(calibration_log)
    assert found.mark_positions.shape == (found.mark_rows * found.mark_columns, 2)
    dark = (found.image_marks.max(axis=2) < 90) & (found.image_empty.max(axis=2) > 150)
    assert dark.sum() > 10 * len(found.mark_positions)
    # Row by row from far to near, each from left to right: the order in which the dots are met in the image.
    rows = found.mark_positions.reshape(found.mark_rows, found.mark_columns, 2)
    assert (np.diff(rows[:, :, 0], axis=0) < 0).all()
    assert (np.diff(rows[:, :, 1], axis=1) < 0).all()


def test_kinds_are_not_confused(trials: list[Log], calibration_log: Log) -> None:
    with pytest.raises(LogError, match="calibration"):
        observation(calibration_log)
    with pytest.raises(LogError, match=topics.CALIBRATION_EMPTY):
        calibration(trials[0])


REQUIRED = [(kind, topic.name) for topic in TOPICS for kind in topic.required]


@pytest.mark.parametrize(("kind", "topic"), REQUIRED)
def test_missing_topics(kind: LogKind, topic: str, trials: list[Log], instruction: Log, calibration_log: Log) -> None:
    log = {"trial": trials[0], "instruction": instruction, "calibration": calibration_log}[kind]
    assert problems(log, kind) == []
    found = problems(_without(log, topic), kind)
    assert any(f"trial_0001.mcap: {topic} is missing" in text for text in found), found


def test_all_missing_topics_at_once(trials: list[Log]) -> None:
    bare = _without(_without(trials[0], "/camera"), "/tactile")
    with pytest.raises(LogError) as caught:
        observation(bare)
    assert all(topic in str(caught.value) for topic in (topics.IMAGE_BEFORE, topics.CAMERA, topics.TACTILE))


def _joints(**change: object) -> Callable[[Value], Value]:
    return lambda value: dataclasses.replace(value, **change)  # type: ignore[type-var]


BAD: list[tuple[str, Callable[[Value], Value], str]] = [
    (topics.TACTILE, lambda _: np.full(9, 1.5), "above 1"),
    (topics.TACTILE, lambda _: np.full(9, -0.1), "below 0"),
    (topics.TACTILE, lambda _: np.full(9, np.nan), "not finite"),
    (topics.TACTILE, lambda _: np.zeros(8), "8 values, 9 are expected"),
    (topics.FINGER_RATE, lambda _: 1.2, "above 1"),
    (topics.FINGER_RATE, lambda _: float("inf"), "not finite"),
    (topics.HAND_POSE, lambda _: np.full(7, np.inf), "not finite"),
    (topics.GAZE_TARGET, lambda _: np.full(3, np.nan), "not finite"),
    (topics.JOINT_STATES, _joints(names=JOINT_NAMES[:-1]), "torso_yaw"),
    (topics.JOINT_STATES, _joints(names=JOINT_NAMES[::-1]), "another order"),
    (topics.JOINT_STATES, _joints(names=(*JOINT_NAMES[:-1], "tail")), "missing: torso_yaw"),
    (topics.JOINT_STATES, _joints(position=np.zeros(24)), "24 positions"),
    (topics.JOINT_STATES, _joints(position=np.full(25, np.nan)), "not finite"),
    (topics.IMAGE_BEFORE, lambda _: np.zeros((8, 8, 3), np.uint8), "too small"),
    (topics.CAMERA, lambda _: CameraInfo(0, 240, np.eye(3), np.zeros(5), "eye"), "positive"),
    (topics.CAMERA, lambda _: CameraInfo(320, 240, np.zeros((3, 3)), np.zeros(5), "eye"), "not calibrated"),
    (topics.TRUTH_SCENE, lambda _: "{", "no JSON"),
]


@pytest.mark.parametrize(("topic", "change", "reason"), BAD)
def test_bad_values(topic: str, change: Callable[[Value], Value], reason: str, trials: list[Log]) -> None:
    with pytest.raises(LogError, match=reason) as caught:
        observation(_with(trials[0], topic, change))
    assert f"trial_0001.mcap: {topic} at" in str(caught.value)
    assert " ns: " in str(caught.value)


@pytest.mark.parametrize("number", ["", "0", "-1", "one", "1.5"])
def test_bad_trial_number(number: str, trials: list[Log]) -> None:
    with pytest.raises(LogError, match="metadata: trial"):
        observation(dataclasses.replace(trials[0], metadata={**trials[0].metadata, "trial": number}))


@pytest.mark.parametrize("change", [{"attended": 7}, {"attended": "x"}, {"objects": [{}]}, {"objects": 3}])
def test_bad_truth(change: dict[str, object], trials: list[Log]) -> None:
    def altered(value: Value) -> Value:
        return json.dumps({**json.loads(str(value)), **change})

    with pytest.raises(LogError, match=topics.TRUTH_SCENE):
        truth(_with(trials[0], topics.TRUTH_SCENE, altered))


def test_joint_states_are_typed(trials: list[Log]) -> None:
    assert all(
        isinstance(message.value, JointState)
        for message in trials[0].messages
        if message.topic == topics.JOINT_STATES
    )
