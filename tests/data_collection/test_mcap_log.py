import os
import shutil
from pathlib import Path

import numpy as np
import pytest

from data_collection.joints import JOINT_NAMES
from data_collection.log import mcap_log, topics
from data_collection.log.mcap_log import Log, LogError, Message, read_log, write_log
from data_collection.log.messages import CameraInfo, JointState, Transform, Value
from data_collection.log_differences import differences
from data_collection.seeding import generator


def _small() -> Log:
    """Return a log with every type of message."""
    rng = generator(1, "log")
    image = rng.integers(0, 256, size=(48, 64, 3), dtype=np.uint8)
    joints = JointState(JOINT_NAMES, rng.normal(size=25), rng.normal(size=25))
    camera = CameraInfo(64, 48, np.diag([50.0, 51.0, 1.0]), np.zeros(5), "eye")
    values: dict[str, Value] = {
        topics.IMAGE_BEFORE: image,
        topics.CAMERA: camera,
        topics.JOINT_STATES: joints,
        topics.TACTILE: rng.random(9),
        topics.HAND_POSE: rng.normal(size=7),
        topics.GAZE_TARGET: rng.normal(size=3),
        topics.FINGER_RATE: 0.25,
        topics.SENTENCE: "touch écarlate",
        topics.TF: (Transform("a", "b", rng.normal(size=7)),),
        topics.TRUTH_POSES: rng.normal(size=(2, 7)),
    }
    messages = tuple(Message(topic, 10**9 + 7 * index, value) for index, (topic, value) in enumerate(values.items()))
    return Log({"trial": "1", "seed": "3"}, messages)


def test_every_type_survives(tmp_path: Path) -> None:
    log = _small()
    write_log(tmp_path / "a.mcap", log)
    assert differences(log, read_log(tmp_path / "a.mcap")) == []
    types = {topics.BY_TOPIC[message.topic].value.type for message in log.messages}
    assert types == {topic.value.type for topic in topics.TOPICS}


def test_real_trial_survives(tmp_path: Path, trials: list[Log]) -> None:
    write_log(tmp_path / "a.mcap", trials[0])
    assert differences(trials[0], read_log(tmp_path / "a.mcap")) == []


def test_differences_are_seen() -> None:
    log = _small()
    changed = list(log.messages)
    image = np.array(changed[0].value)
    image[3, 4, 1] ^= 1
    changed[0] = Message(changed[0].topic, changed[0].time, image)
    assert differences(log, Log(log.metadata, tuple(changed))) == [
        f"{topics.IMAGE_BEFORE} at {10**9} ns: values differ"
    ]
    assert differences(log, Log({**log.metadata, "seed": "4"}, log.messages)) == ["metadata seed: '3' and '4'"]
    assert differences(log, Log(log.metadata, log.messages[:-1])) == ["10 and 9 messages"]


def test_same_log_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        write_log(tmp_path / name, _small())
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_no_silent_corruption(tmp_path: Path) -> None:
    """200 random damages, of bits, bytes, length and middle: every one is refused, and the file is named."""
    log = _small()
    path = tmp_path / "trial_0007.mcap"
    write_log(path, log)
    whole = path.read_bytes()
    rng = generator(1, "corruption")
    for number in range(200):
        damaged = bytearray(whole)
        kind = number % 4
        at = int(rng.integers(len(whole)))
        if kind == 0:
            damaged[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            damaged = damaged[:at]
        elif kind == 2:
            length = int(rng.integers(2, 64))
            damaged[at : at + length] = rng.integers(0, 256, size=length, dtype=np.uint8).tobytes()
        else:
            length = int(rng.integers(1, 64))
            del damaged[at : at + length]
        path.write_bytes(damaged)
        with pytest.raises(LogError, match=r"trial_0007\.mcap"):
            read_log(path)


@pytest.mark.parametrize("content", [b"", b"hello", b"\x89MCAP0\r\n", b"\x89MCAP0\r\n" * 2])
def test_no_log(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "a.mcap").write_bytes(content)
    with pytest.raises(LogError, match=r"a\.mcap"):
        read_log(tmp_path / "a.mcap")


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="no such file"):
        read_log(tmp_path / "none.mcap")


def test_something_after_the_end(tmp_path: Path) -> None:
    write_log(tmp_path / "a.mcap", _small())
    with (tmp_path / "a.mcap").open("ab") as stream:
        stream.write(b"\0")
    with pytest.raises(LogError, match=r"a\.mcap"):
        read_log(tmp_path / "a.mcap")


def test_foreign_topics_are_passed_over_and_wrong_types_are_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = _small()
    write_log(tmp_path / "a.mcap", log)
    without = {name: topic for name, topic in topics.BY_TOPIC.items() if name != topics.TACTILE}
    monkeypatch.setattr(mcap_log, "BY_TOPIC", without)
    assert len(read_log(tmp_path / "a.mcap").messages) == len(log.messages) - 1
    wrong = {**without, topics.TACTILE: topics.BY_TOPIC[topics.SENTENCE]}
    monkeypatch.setattr(mcap_log, "BY_TOPIC", wrong)
    with pytest.raises(
        LogError, match=rf"a\.mcap: {topics.TACTILE} at \d+ ns is of type std_msgs/msg/Float64MultiArray"
    ):
        read_log(tmp_path / "a.mcap")


def test_unknown_topics_and_disorder_are_not_written(tmp_path: Path) -> None:
    with pytest.raises(LogError, match="/nowhere"):
        write_log(tmp_path / "a.mcap", Log({}, (Message("/nowhere", 0, "x"),)))
    late = (Message(topics.SENTENCE, 5, "x"), Message(topics.SENTENCE, 4, "y"))
    with pytest.raises(LogError, match="time order"):
        write_log(tmp_path / "a.mcap", Log({}, late))
    assert list(tmp_path.iterdir()) == []


def test_nothing_half_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A failure in the middle of writing leaves the old file and no other."""
    path = tmp_path / "a.mcap"
    write_log(path, _small())
    before = path.read_bytes()
    bad = Log({}, (Message(topics.SENTENCE, 0, "x"), Message(topics.TACTILE, 1, "no numbers")))
    with pytest.raises((ValueError, TypeError)):
        write_log(path, bad)
    assert [item.name for item in tmp_path.iterdir()] == ["a.mcap"]
    assert path.read_bytes() == before


def test_killed_while_writing(tmp_path: Path) -> None:
    """A process that dies in the middle leaves no file under the log's name."""
    pid = os.fork()
    if pid == 0:
        real = mcap_log._write

        def dies(stream: object, log: Log) -> None:
            real(stream, log)
            os._exit(9)

        mcap_log._write = dies
        write_log(tmp_path / "a.mcap", _small())
        os._exit(0)
    _, status = os.waitpid(pid, 0)
    assert os.waitstatus_to_exitcode(status) == 9
    assert not (tmp_path / "a.mcap").exists()
    shutil.rmtree(tmp_path)
