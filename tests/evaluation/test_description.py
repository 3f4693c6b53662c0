"""Descriptions against brute force, and their measures against scikit-learn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from sklearn.metrics import accuracy_score, f1_score

from evaluation.description import COLUMNS, FRAME, describe_trials
from evaluation.measures import measured
from evaluation.metrics import accuracy, confusion, f1_macro
from features.table import FeatureTable
from model import Fit
from model.prediction import responsibilities
from tests.evaluation.conftest import fit_of
from tests.synthetic import WORDS


def test_each_word_is_the_most_probable_of_its_channel(proposed: Fit, table: FeatureTable) -> None:
    told = describe_trials(proposed, table, WORDS)
    assert len(told) == 4 * len(table.trial)
    assert tuple(told["channel"][:4]) == FRAME
    names = [channel.name for channel in proposed.trials.channels]
    for d, row in enumerate(table.attended_row):
        seen = {"action": table.action[d], "position": table.position[row]}
        seen |= {"object": table.object_feature[row], "color": table.color[row]}
        for n, channel in enumerate(FRAME):
            r = np.exp(responsibilities(proposed.state, names.index(channel), seen[channel][None]))[0]
            theta = np.exp(proposed.state.log_words[names.index(channel)])
            by_word = {w: sum(r[j] * theta[j, w] for j in range(len(r))) for w in range(theta.shape[1])}
            best = max(by_word, key=lambda w: float(by_word[w]))
            assert told["described"][4 * d + n] == proposed.trials.vocabulary[best]


def test_truth_is_what_the_tutor_said(proposed: Fit, table: FeatureTable) -> None:
    told = describe_trials(proposed, table, WORDS)
    assert table.truth_action is not None
    assert tuple(told["true"][::4]) == tuple(table.truth_action)
    silent = replace(table, words=tuple(() for _ in table.words))
    nothing = measured("description", describe_trials(proposed, silent, WORDS), WORDS)
    assert nothing == {"F1": None, "ACC": None, "ACC_chance": None}


def test_no_description_was_learned_without_words(table: FeatureTable) -> None:
    """Without a sentence the vocabulary is still known, and every word is as probable as any other."""
    told = describe_trials(fit_of(table, "gmm", words=False), table, WORDS)
    assert len(told) == 4 * len(table.trial)


def test_measures_are_those_of_scikit_learn() -> None:
    true, said = ["a", "b", "c", "a", "b"], ["a", "b", "a", "d", "b"]
    assert accuracy(true, said) == accuracy_score(true, said) == 0.6
    assert f1_macro(true, said) == pytest.approx(
        f1_score(true, said, labels=["a", "b", "c", "d"], average="macro", zero_division=0)
    )
    # By hand: a 2·1/(2+2), b 1, c and d 0.
    assert f1_macro(true, said) == pytest.approx((0.5 + 1.0) / 4)


def test_chance_of_a_word() -> None:
    words = {"action": ["reach", "touch", "grasp", "look-at"], "color": ["red", "blue"]}
    pairs = [(1, "action", "reach", "touch"), (1, "color", "red", "red"), (2, "color", "blue", "red")]
    told = pd.DataFrame(pairs, columns=COLUMNS)
    assert measured("description", told, words)["ACC_chance"] == pytest.approx(1.25 / 3)


def test_a_confusion_matrix_counts_every_pair() -> None:
    true, said = ["a", "b", "c", "a", "b"], ["a", "b", "a", "d", "b"]
    counts = confusion(true, said, ["d", "c", "b", "a"])
    assert counts.sum() == 5
    assert counts[3].tolist() == [1, 0, 0, 1]
    assert counts[:, 0].tolist() == [0, 0, 0, 1]
