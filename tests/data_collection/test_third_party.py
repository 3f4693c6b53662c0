"""Logs opened by readers that share no code with ours, with the type definitions in the file."""

from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from data_collection.joints import JOINT_NAMES
from data_collection.log import topics
from data_collection.log.codec import decode_image
from data_collection.log.mcap_log import Log, write_log
from data_collection.log.messages import JointState


@pytest.fixture(scope="module")
def log_path(trials: list[Log], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("logs") / "trial_0001.mcap"
    write_log(path, trials[0])
    return path


def test_rosbags_reads_everything(log_path: Path, trials: list[Log]) -> None:
    ours = trials[0].messages
    with AnyReader([log_path]) as reader:
        types = {connection.topic: connection.msgtype for connection in reader.connections}
        found = [
            (connection.topic, time, reader.deserialize(data, connection.msgtype))
            for connection, time, data in reader.messages()
        ]
    assert types == {topic: topics.BY_TOPIC[topic].value.type for topic in {message.topic for message in ours}}
    assert sorted((topic, time) for topic, time, _ in found) == sorted(
        (message.topic, message.time) for message in ours
    )


def test_rosbags_decodes_the_same_values(log_path: Path, trials: list[Log]) -> None:
    ours = {(message.topic, message.time): message.value for message in trials[0].messages}
    with AnyReader([log_path]) as reader:
        for connection, time, data in reader.messages():
            message, value = reader.deserialize(data, connection.msgtype), ours[connection.topic, time]
            if connection.topic == topics.JOINT_STATES:
                assert isinstance(value, JointState)
                assert tuple(message.name) == JOINT_NAMES
                assert np.array_equal(message.position, value.position)
            elif connection.msgtype == topics.IMAGE:
                assert message.format == "png"
                assert message.header.frame_id == topics.CAMERA_FRAME
                assert np.array_equal(decode_image(message.data.tobytes()), np.asarray(value))
            elif connection.topic == topics.SENTENCE:
                assert message.data == value
            elif connection.topic == topics.TACTILE:
                assert np.array_equal(message.data, np.asarray(value))
            if hasattr(message, "header"):
                stamp = message.header.stamp
                assert stamp.sec * 10**9 + stamp.nanosec == time


def test_mcap_indexed_reader_agrees(log_path: Path, trials: list[Log]) -> None:
    """The seeking reader of the mcap package uses the summary: index, statistics and metadata must be right too."""
    from mcap.reader import make_reader

    with log_path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == len(trials[0].messages)
        assert reader.get_header().profile == "ros2"
        [metadata] = list(reader.iter_metadata())
        assert metadata.metadata == dict(trials[0].metadata)
        assert sum(1 for _ in reader.iter_messages()) == len(trials[0].messages)
        assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
