"""Measures against hand-made cases."""

from __future__ import annotations

import numpy as np
import pytest

from evaluation.metrics import (
    adjusted_rand_index,
    channel_by_word,
    estimation_accuracy_rate,
    precision_and_recall,
)


def test_ari_is_one_up_to_names_and_zero_for_one_category() -> None:
    truth = ["a", "a", "b", "b", "c", "c"]
    assert adjusted_rand_index(np.array([7, 7, 2, 2, 0, 0]), truth) == 1.0
    assert adjusted_rand_index(np.zeros(6, dtype=np.int64), truth) == 0.0


def test_ari_of_a_textbook_table() -> None:
    """Hubert and Arabie's formula by hand: index 2, expected 3·3/15, maximum 3."""
    truth = ["a", "a", "a", "b", "b", "b"]
    z = np.array([0, 0, 1, 1, 2, 2])
    # Pairs together in both: (0,1) and (4,5) = 2; in truth: 6; in z: 3; of 15 pairs.
    expected = 6 * 3 / 15
    assert adjusted_rand_index(z, truth) == pytest.approx((2 - expected) / ((6 + 3) / 2 - expected))


def test_ari_leaves_unknown_classes_out() -> None:
    assert adjusted_rand_index(np.array([0, 0, 1, 0]), ["a", "a", "b", None]) == 1.0
    assert adjusted_rand_index(np.array([0, 1]), [None, None]) is None
    assert adjusted_rand_index(np.array([0, 1]), None) is None


def test_ari_is_undefined_where_chance_cannot_do_otherwise() -> None:
    for z, truth in (([3], ["a"]), ([3, 3], ["a", "a"]), ([0, 1, 2], ["a", "b", "c"]), ([0, 1], ["a", None])):
        assert adjusted_rand_index(np.array(z), truth) is None
    # One of the two alone is no such case.
    assert adjusted_rand_index(np.array([0, 1, 1]), ["a", "a", "a"]) == 0.0
    assert adjusted_rand_index(np.array([0, 0, 1]), ["a", "b", "c"]) == 0.0


def test_ear_counts_words() -> None:
    assert estimation_accuracy_rate(np.array([0, 1, 2, 3]), [0, 1, 3, 2]) == 0.5
    assert estimation_accuracy_rate(np.array([0, 1, 2]), [0, None, 2]) == 1.0


def test_ear_is_undefined_without_words() -> None:
    assert estimation_accuracy_rate(np.array([], dtype=np.int64), []) is None


def test_the_true_channel_of_each_word() -> None:
    words = {"color": ["red"], "action": ["grasp", "touch"]}
    assert channel_by_word(words, ["action", "color"]) == {"red": 1, "grasp": 0, "touch": 0}


def test_words_of_no_channel_are_behind_the_channels() -> None:
    assert channel_by_word({"color": ["red"], "none": ["the"]}, ["action", "color"]) == {"red": 1, "the": 2}


def test_precision_and_recall_leave_out_words_of_unknown_channel() -> None:
    F = np.array([2, 2, 2, 0, 1, 2])
    assert precision_and_recall(F, [2, 2, 0, 2, 1, None], 2) == (2 / 3, 2 / 3)
    assert precision_and_recall(F[:3], [2, 2, 0], 2) == (2 / 3, 1.0)
    assert precision_and_recall(F[3:5], [2, 1], 2) == (None, 0.0)
    assert precision_and_recall(F[:1], [0], 2) == (0.0, None)
