"""The log joint of the truth: of a state made by hand, and nothing where the truth is no state of the method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from evaluation.truth import truth_log_joint
from features.table import FeatureTable
from model import METHODS, Prior, Problem, Trials
from model.joint import log_marginal_joint
from model.state import Partition
from tests.synthetic import WORDS


def problem_of(table: FeatureTable, method: str = "proposed", K: int = 10) -> Problem:
    trials = Trials.from_arrays(**table.learning_input())
    if not METHODS[method].hears_words:
        trials = trials.keep_words(np.zeros(len(trials.word_trial), dtype=bool))
    return Problem.of(trials, method, Prior(categories=K))


def attended_alone(table: FeatureTable) -> FeatureTable:
    """The table without the objects that nobody speaks of."""
    rows, count = table.attended_row, len(table.trial)
    truths = {
        f"truth_{x}": tuple(getattr(table, f"truth_{x}")[i] for i in rows) for x in ("position", "object", "color")
    }
    features = {x: getattr(table, x)[rows] for x in ("position", "object_feature", "color")}
    return replace(
        table, attended_object=np.zeros(count, dtype=np.int64), trial_index=np.arange(count), **features, **truths
    )


@pytest.mark.parametrize("method", METHODS)
def test_where_all_is_spoken_of_it_is_that_of_the_state(table: FeatureTable, method: str) -> None:
    alone = attended_alone(table)
    problem = problem_of(alone, method)
    channels = problem.trials.channels
    z = tuple(np.unique(getattr(alone, f"truth_{channel.name}"), return_inverse=True)[1] for channel in channels)
    channel_of = {word: c for c, own in enumerate(WORDS.values()) for word in own}
    F = np.array([channel_of[problem.trials.vocabulary[w]] for w in problem.trials.words[0]], dtype=np.int64)
    expected = log_marginal_joint(problem, Partition(z, F if problem.method.has_frames else F[:0]))
    assert truth_log_joint(problem, alone, WORDS) == pytest.approx(expected, abs=1e-9)
    # No other truth has it.
    wrong = replace(alone, truth_color=tuple(np.roll(np.array(alone.truth_color), 1).tolist()))
    assert truth_log_joint(problem, wrong, WORDS) != pytest.approx(expected, abs=1.0)


def test_fits_of_one_posterior_are_told_the_same(table: FeatureTable) -> None:
    first, second = (truth_log_joint(problem_of(table), table, WORDS) for _ in range(2))
    assert first is not None
    assert first == second
    mixed = truth_log_joint(problem_of(table), table, WORDS | {"color": WORDS["object"], "object": WORDS["color"]})
    assert mixed is not None
    assert mixed < first - 5


def changed(truth: Sequence[str | None] | None, row: int) -> tuple[str | None, ...]:
    """The classes without that of one row."""
    assert truth is not None
    return tuple(None if i == row else name for i, name in enumerate(truth))


def test_it_is_not_defined_where_a_class_is_not_known(table: FeatureTable) -> None:
    problem, whole = problem_of(table), truth_log_joint(problem_of(table), table, WORDS)
    (spoken, *_), rows = table.attended_row, range(len(table.trial_index))
    silent = next(row for row in rows if row not in table.attended_row)
    assert truth_log_joint(problem, replace(table, truth_color=None), WORDS) is None
    assert truth_log_joint(problem, replace(table, truth_color=changed(table.truth_color, spoken)), WORDS) is None
    assert truth_log_joint(problem, replace(table, truth_action=changed(table.truth_action, 0)), WORDS) is None
    assert truth_log_joint(problem, replace(table, truth_color=changed(table.truth_color, silent)), WORDS) == whole


def test_it_is_not_defined_with_more_classes_than_categories(table: FeatureTable) -> None:
    classes = max(len(set(getattr(attended_alone(table), f"truth_{channel}"))) for channel in WORDS)
    assert truth_log_joint(problem_of(table, K=classes - 1), table, WORDS) is None
    assert truth_log_joint(problem_of(table, K=classes), table, WORDS) is not None


@pytest.mark.parametrize("method", [name for name, method in METHODS.items() if method.hears_words])
def test_it_is_not_defined_where_frames_do_not_allow_it(table: FeatureTable, method: str) -> None:
    """Two words of one channel in a sentence, and a word of no channel, which methods without frames do not mind."""
    sentence = (*(word for word in table.words[0] if word not in WORDS["color"]), WORDS["object"][0])
    twice = replace(table, words=(sentence, *table.words[1:]))
    found = truth_log_joint(problem_of(twice, method), twice, WORDS)
    assert (found is None) == (METHODS[method].frame_prior.most_per_channel == 1)
    strange = replace(table, words=(("hello",), *table.words[1:]))
    found = truth_log_joint(problem_of(strange, method), strange, WORDS)
    assert (found is None) == METHODS[method].has_frames


@pytest.mark.parametrize("method", [name for name, method in METHODS.items() if method.has_frames])
def test_words_of_no_channel_are_a_state_of_methods_that_have_such(table: FeatureTable, method: str) -> None:
    said = replace(table, words=(("hello", *table.words[0][:2]), *table.words[1:]))
    found = truth_log_joint(problem_of(said, method), said, WORDS | {"none": ["hello"]})
    assert (found is not None) == METHODS[method].frame_prior.has_none
