"""Chance levels against what guessing gives."""

from __future__ import annotations

import pandas as pd
import pytest

from evaluation.chance import description_chance, generation_chance

WORDS = {"action": ["reach", "touch", "grasp", "look-at"], "color": ["red", "blue"]}


def test_chance_of_the_object_and_of_the_action() -> None:
    """Three instructions, of which the object of the last is not known."""
    answered = pd.DataFrame(
        {
            "objects": [2, 3, 1],
            "object_right": [1.0, 0.0, None],
            "action": ["reach", "touch", "touch"],
            "judged": ["reach", None, None],
        }
    )
    levels = generation_chance(answered, WORDS)
    assert levels == {"OAR_chance": pytest.approx((1 / 2 + 1 / 3) / 2), "WAR_chance": 0.25}


def test_nothing_executed_and_nothing_known() -> None:
    answered = pd.DataFrame({"objects": [2], "object_right": [None], "action": ["reach"], "judged": [None]})
    assert generation_chance(answered, WORDS) == {"OAR_chance": None, "WAR_chance": None}


def test_chance_of_a_word() -> None:
    assert description_chance(["action", "color", "color"], WORDS) == {"ACC_chance": pytest.approx(1.25 / 3)}
    assert description_chance([], WORDS) == {"ACC_chance": None}
