"""The 38 numbers: names, scaling, its inverse, and the hand's target."""

import logging

import numpy as np
import pytest

from data_collection.joints import JOINT_NAMES
from features.action import HAND, Scale, action_names, fit_action_scale, hand_target, within_limits

LOWER, UPPER = np.full(25, -0.5), np.linspace(0.5, 1.5, 25)
HANDS = np.array([[0.0, 0.1, 0.05], [0.2, -0.1, 0.05], [0.1, 0.0, 0.05]])


@pytest.fixture
def scale() -> Scale:
    return fit_action_scale(HANDS, LOWER, UPPER)


def test_names_are_38_in_the_papers_order() -> None:
    names = action_names(JOINT_NAMES)
    assert len(names) == len(set(names)) == 38
    assert names[:5] == ("hand_x", "hand_y", "hand_z", "finger_rate", "neck_pitch")
    assert names[10] == "r_shoulder_pitch"
    assert names[26:30] == ("torso_pitch", "torso_roll", "torso_yaw", "thumb_tip")


def test_limits_and_training_ranges_become_0_and_1(scale: Scale) -> None:
    low = np.concatenate([HANDS.min(axis=0), [0.0], LOWER, np.zeros(9)])
    high = np.concatenate([HANDS.max(axis=0), [1.0], UPPER, np.ones(9)])
    assert (scale.scale(low) == 0).all()
    expected = np.ones(38)
    expected[2] = 0  # the hand was always at one height: a range of zero maps to 0
    np.testing.assert_array_equal(scale.scale(high), expected)
    high[2] = 0.09  # another height, in a test scene
    assert scale.scale(high)[2] == 0


def test_unscale_undoes_scale(scale: Scale) -> None:
    raw = np.random.default_rng(0).normal(size=(7, 38))
    raw[:, 2] = 0.05
    np.testing.assert_allclose(scale.unscale(scale.scale(raw)), raw, atol=1e-12)


def test_hand_target_adds_the_objects_position(scale: Scale) -> None:
    action = scale.scale(np.concatenate([[0.05, 0.02, 0.05], np.zeros(35)]))
    target = hand_target(scale, action, np.array([[0.3, -0.1], [0.2, 0.1]]), table_height=-0.06)
    np.testing.assert_allclose(target, [[0.35, -0.08, -0.01], [0.25, 0.12, -0.01]], atol=1e-12)


def test_joints_are_held_within_limits_and_the_hand_is_not(caplog: pytest.LogCaptureFixture) -> None:
    scaled = np.full((1, 38), 0.5)
    scaled[0, [0, 5, 6]] = [1.7, 1.02, -1.4]
    with caplog.at_level(logging.WARNING):
        bounded = within_limits(scaled, action_names(JOINT_NAMES), np.array([12]))
    assert bounded[0, [0, 5, 6]].tolist() == [1.7, 1.0, 0.0]
    assert caplog.messages == ["trial 12: neck_yaw is at -1.40 of its range; taken as 0"]
    assert HAND == slice(0, 3)
