import re
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.__main__ import topics
from data_collection.joints import JOINT_NAMES, TACTILE_NAMES
from data_collection.log.mcap_log import read_log
from data_collection.log.trial import observation
from data_collection.log.validation import problems

TEXT = (Path(__file__).parents[2] / "docs/logs.md").read_text(encoding="utf-8")


def test_topics_are_those_of_the_code() -> None:
    assert topics() in TEXT
    assert all(f"`{name}`" in TEXT for name in (*JOINT_NAMES, *TACTILE_NAMES))


def test_converter_writes_a_sound_log(tmp_path: Path) -> None:
    [code] = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)
    namespace: dict[str, Any] = {}
    exec(code, namespace)
    images = [np.full((300, 400, 3), value, dtype=np.uint8) for value in (10, 20, 30)]
    namespace["convert"](tmp_path / "a.mcap", 3, images, np.zeros((20, 25)), "touch left red cup")
    log = read_log(tmp_path / "a.mcap")
    assert problems(log) == []
    assert observation(log).words == ("touch", "left", "red", "cup")
    assert observation(log).trial == 3
