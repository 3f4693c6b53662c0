"""Instructions: what is chosen, what the body is told to do, and how it is measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.acting import commands
from evaluation.generation import answers, objects_of, read_answers, write_answers
from evaluation.measures import measured
from features.table import FeatureTable
from features.transforms import Transforms
from model import Fit
from model.prediction import Answer
from tests.synthetic import WORDS

REST = np.array([0.05, -0.3, 0.2])


@pytest.fixture
def transforms(table: FeatureTable) -> Transforms:
    """Scales of an action of five numbers: hand (3), finger rate, one joint."""
    return Transforms(
        action_names=("hand_x", "hand_y", "hand_z", "finger_rate", "joint"),
        action_lowest=np.array([-0.1, -0.1, 0.0, 0.0, -1.0]),
        action_highest=np.array([0.1, 0.1, 0.2, 1.0, 1.0]),
        table_height=np.array(0.0),
        pca_mean=np.zeros(6),
        pca_components=np.eye(6),
        feature_lowest=np.zeros(6),
        feature_highest=np.ones(6),
        codebook=np.zeros((10, 3)),
        provenance="test",
    )


def with_mean(fit: Fit, mean: list[float]) -> Fit:
    """The fit with one action mean for all categories."""
    means = (np.tile(mean, (len(fit.state.mean[0]), 1)), *fit.state.mean[1:])
    return replace(fit, state=replace(fit.state, mean=means))


def test_objects_are_those_of_the_trial(table: FeatureTable) -> None:
    counts = [len(objects_of(table, d)["color"]) for d in range(len(table.trial))]
    assert counts == np.bincount(table.trial_index).tolist()
    assert np.array_equal(objects_of(table, 3)["position"], table.position[table.trial_index == 3])


def test_the_instructed_object_is_not_looked_at(proposed: Fit, table: FeatureTable) -> None:
    blind = replace(table, attended_object=np.full(len(table.trial), -1))
    for seen, unseen in zip(answers(proposed, table), answers(proposed, blind), strict=True):
        assert np.array_equal(seen.log_scores, unseen.log_scores)


def test_the_hand_goes_to_the_object(proposed: Fit, table: FeatureTable, transforms: Transforms) -> None:
    """0.75 of the range of x is 5 cm ahead of the object, 0.5 of y beside it, 0.25 of z 5 cm above the table."""
    fit = with_mean(proposed, [0.75, 0.5, 0.25, 0.4, 0.0])
    answered = answers(fit, table)
    told = commands(np.random.default_rng(0), fit, transforms, table, answered, np.tile(REST, (len(answered), 1)))
    for d, command in enumerate(told):
        m, _ = answered[d].choices()[0]
        place = objects_of(table, d)["position"][m]
        assert command.trial == table.trial[d]
        assert np.array_equal(command.gaze, place)
        assert command.target == pytest.approx([place[0] + 0.05, place[1], 0.05])
        assert command.finger_rate == pytest.approx(0.4)


def test_the_mean_of_a_category_is_that_of_the_parameters_in_use(
    proposed: Fit, table: FeatureTable, transforms: Transforms
) -> None:
    """At the summary categories have other numbers and means than in the last state."""
    sampler = proposed.sampler.model_copy(update={"parameters": "mean"})
    fit = with_mean(replace(proposed, sampler=sampler), [-1.2, -2.0, 1.0, 0.4, 0.0])
    answered = answers(fit, table)
    told = commands(np.random.default_rng(0), fit, transforms, table, answered, np.tile(REST, (len(answered), 1)))
    assert any(command.target is not None for command in told)  # the means of the last state are all looks
    for d, command in enumerate(told):
        if command.target is not None:
            m, k = answered[d].choices()[0]
            mean, place = fit.knowledge.categories.mean[0][k], objects_of(table, d)["position"][m]
            assert command.target == pytest.approx(transforms.hand_target(mean, place))


def test_a_target_near_the_rest_posture_is_a_look(proposed: Fit, table: FeatureTable, transforms: Transforms) -> None:
    fit = with_mean(proposed, [-1.2, -2.0, 1.0, 0.4, 0.0])  # 34 cm back, 50 cm to the right, 20 cm up
    answered = answers(fit, table)
    told = commands(np.random.default_rng(0), fit, transforms, table, answered, np.tile(REST, (len(answered), 1)))
    assert {command.target is None for command in told} == {True}
    assert {command.finger_rate for command in told} == {0.0}


def test_answers_are_kept_and_measured(table: FeatureTable, tmp_path: Path) -> None:
    """Three instructions: right object and action; tied between two of three objects; wrong object, wrong action."""
    first = replace(table, attended_object=np.zeros(len(table.trial), dtype=np.int64))
    scores = [np.full((3, 2), -9.0) for _ in table.trial]
    scores[0][0, 1] = 0.0
    scores[1][0, 0] = scores[1][2, 0] = 0.0
    for d in range(2, len(scores)):
        scores[d][1, 0] = 0.0
    assert table.truth_action is not None
    judged: list[str | None] = [table.truth_action[0], None, *("nothing" for _ in scores[2:])]
    write_answers(first, [Answer(score, ("blorp",)) for score in scores], judged, tmp_path / "answers.csv")
    kept = read_answers(tmp_path / "answers.csv")
    assert kept["object_right"].tolist()[:3] == [1.0, 0.5, 0.0]
    assert kept["chosen"].tolist()[:3] == ["0", "0 2", "1"]
    assert kept["ignored"].tolist()[0] == "blorp"
    n = len(scores)
    measures = measured("generation", kept, WORDS)
    assert [measures["OAR"], measures["WAR"]] == pytest.approx([1.5 / n, 1 / (n - 1)])


def test_unknown_truth_leaves_the_measures_empty(proposed: Fit, table: FeatureTable, tmp_path: Path) -> None:
    blind = replace(table, attended_object=np.full(len(table.trial), -1), truth_action=None)
    write_answers(blind, answers(proposed, blind), [None] * len(table.trial), tmp_path / "answers.csv")
    measures = measured("generation", read_answers(tmp_path / "answers.csv"), WORDS)
    assert (measures["OAR"], measures["WAR"]) == (None, None)


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
    measures = measured("generation", answered, {"action": ["reach", "touch", "grasp", "look-at"]})
    assert measures["OAR_chance"] == pytest.approx((1 / 2 + 1 / 3) / 2)
    assert measures["WAR_chance"] == 0.25


def test_nothing_executed_and_nothing_known() -> None:
    answered = pd.DataFrame({"objects": [2], "object_right": [None], "action": ["reach"], "judged": [None]})
    assert set(measured("generation", answered, WORDS).values()) == {None}
