"""Logs decoded by Foxglove's own packages on Node; skipped where Node or the packages cannot be had."""

import json
import shutil
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from data_collection.joints import JOINT_NAMES
from data_collection.log import topics
from data_collection.log.codec import decode_image
from data_collection.log.mcap_log import Log, write_log
from data_collection.log.messages import JointState

HERE = Path(__file__).parent / "foxglove"
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def decoded(trials: list[Log], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    if shutil.which("node") is None or shutil.which("npm") is None:
        pytest.skip("Node.js is not installed")
    folder = tmp_path_factory.mktemp("foxglove")
    shutil.copytree(HERE, folder, dirs_exist_ok=True)
    install = subprocess.run(
        ["npm", "ci", "--silent", "--no-audit", "--no-fund"], cwd=folder, capture_output=True, text=True, check=False
    )
    if install.returncode:
        pytest.skip(f"npm ci failed, perhaps for want of a network: {install.stderr[-300:]}")
    write_log(folder / "trial_0001.mcap", trials[0])
    done = subprocess.run(
        ["node", "read.mjs", "trial_0001.mcap"], cwd=folder, capture_output=True, text=True, check=True
    )
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def test_every_message_is_decoded(decoded: dict[str, Any], trials: list[Log]) -> None:
    assert decoded["profile"] == "ros2"
    assert decoded["counts"] == Counter(message.topic for message in trials[0].messages)


def test_the_values_are_ours(decoded: dict[str, Any], trials: list[Log]) -> None:
    ours = {message.topic: message.value for message in trials[0].messages}
    joints = ours[topics.JOINT_STATES]
    assert isinstance(joints, JointState)
    assert decoded["last"][topics.JOINT_STATES]["name"] == list(JOINT_NAMES)
    assert decoded["last"][topics.JOINT_STATES]["position"] == np.asarray(joints.position).tolist()
    assert decoded["last"][topics.SENTENCE]["data"] == ours[topics.SENTENCE]
    image = bytes(decoded["last"][topics.IMAGE_AFTER]["data"])
    assert np.array_equal(decode_image(image), np.asarray(ours[topics.IMAGE_AFTER]))
