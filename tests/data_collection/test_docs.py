from pathlib import Path

from data_collection.__main__ import topics
from data_collection.joints import JOINT_NAMES, TACTILE_NAMES

TEXT = (Path(__file__).parents[2] / "docs/logs.md").read_text(encoding="utf-8")


def test_topics_are_those_of_the_code() -> None:
    assert topics() in TEXT
    assert all(f"`{name}`" in TEXT for name in (*JOINT_NAMES, *TACTILE_NAMES))
