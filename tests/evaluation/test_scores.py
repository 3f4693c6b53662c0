"""Measures of fits, and the file that they are kept in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.learned import Learned
from evaluation.measures import measured
from evaluation.scores import COLUMNS, read_scores, score_rows, write_csv, write_scores
from evaluation.truth import truth_log_joint
from features.table import FeatureTable
from model import Fit, History
from model.state import Partition
from model.summaries import summarise
from tests.evaluation.conftest import fit_of
from tests.synthetic import WORDS

CONDITION = {"experiment": "own", "variant": "default", "task": "csl", "method": "proposed", "sampler": "published"}
NUMBERS = {"dataset": 1, "D": 12, "ROW": 0, "seed": 1}


def perfect(fit: Fit, table: FeatureTable) -> Fit:
    """The fit with the truth in place of what was estimated, in the last state and in each kept one."""
    truths = [getattr(table, f"truth_{channel.name}") for channel in fit.trials.channels]
    z = tuple(np.unique(truth, return_inverse=True)[1] for truth in truths)
    channel = {word: c for c, name in enumerate(WORDS) for word in WORDS[name]}
    F = np.array([channel[fit.trials.vocabulary[w]] for w in fit.trials.words[0]])
    history = History.of(np.arange(1, 16), [Partition(z, F)] * 15)
    state = replace(fit.state, z=z, F=F)
    return replace(fit, state=state, history=history, summary=summarise(fit.problem, history))


def test_the_truth_scores_one(proposed: Fit, table: FeatureTable) -> None:
    """Of the last state, of the summary, and in every kept state, when all of them are the truth."""
    measures = measured("csl", Learned(perfect(proposed, table), table), WORDS)
    agreements = {name: value for name, value in measures.items() if name.startswith(("ARI", "EAR"))}
    assert len(agreements) == 14 + 8 + 4
    assert agreements == pytest.approx(dict.fromkeys(agreements, 1.0))
    assert measures["word_entropy"] == 0.0
    assert measures["used_a"] == len(set(table.truth_action or ()))


def test_attended_measures_see_attended_objects_only(proposed: Fit, table: FeatureTable) -> None:
    """Categories of objects that nobody attends to, made wrong on purpose."""
    fit = perfect(proposed, table)
    z = [part.copy() for part in fit.state.z]
    unattended = np.setdiff1d(np.arange(len(z[2])), table.attended_row)
    z[2][unattended] = np.arange(len(unattended)) % 10
    measures = measured("csl", Learned(replace(fit, state=replace(fit.state, z=tuple(z))), table), WORDS)
    assert measures["ARI_o_attended"] == 1.0
    assert measures["ARI_o"] is not None
    assert measures["ARI_o"] < 1.0


def test_a_wrong_frame_costs_one_word(proposed: Fit, table: FeatureTable) -> None:
    fit = perfect(proposed, table)
    F = fit.state.F.copy()
    F[0] = (F[0] + 1) % 4
    measures = measured("csl", Learned(replace(fit, state=replace(fit.state, F=F)), table), WORDS)
    assert measures["EAR"] == pytest.approx(1 - 1 / len(F))


def test_the_last_state_the_mode_and_the_interval_are_measured_apart(proposed: Fit, table: FeatureTable) -> None:
    """Ten states after a burn-in of a third; the first word is wrong in all of them but one."""
    fit = perfect(proposed, table)
    assert fit.history is not None
    F = fit.history.F.copy()
    F[5:14, 0] = (F[0, 0] + 1) % 4
    z = list(fit.history.z)
    z[3] = z[3].copy()
    z[3][5:14] = 0
    history = replace(fit.history, F=F, z=tuple(z))
    sampler = fit.sampler.model_copy(update={"burn_in": 1 / 3})
    fit = replace(fit, sampler=sampler, history=history)
    assert fit.kept is not None
    assert fit.kept.iterations.tolist() == list(range(6, 16))
    fit = replace(fit, summary=summarise(fit.problem, fit.kept))
    measures = measured("csl", Learned(fit, table), WORDS)
    wrong = 1 - 1 / F.shape[1]
    assert measures["EAR"] == 1.0
    assert measures["EAR_mode"] == pytest.approx(wrong)
    along = [wrong] * 9 + [1.0]
    assert measures["EAR_low"] == pytest.approx(wrong)
    assert measures["EAR_high"] == pytest.approx(np.quantile(along, 0.975))
    assert (measures["ARI_c"], measures["ARI_c_summary"], measures["ARI_c_attended_summary"]) == (1.0, 0.0, 0.0)
    assert measures["ARI_c_low"] == 0.0
    assert measures["ARI_o_low"] == pytest.approx(1.0)
    entropy = -(0.9 * np.log(0.9) + 0.1 * np.log(0.1))
    assert measures["word_entropy"] == pytest.approx(entropy / F.shape[1])
    assert measures["log_joint"] == pytest.approx(fit.trace_log_joint[5:].mean(), rel=1e-12)


def test_the_truth_has_a_log_joint_of_its_own(proposed: Fit, table: FeatureTable) -> None:
    """It hangs on data, method and priors, not on what a fit has found."""
    found, right = (measured("csl", Learned(fit, table), WORDS) for fit in (proposed, perfect(proposed, table)))
    assert found["log_joint_truth"] == right["log_joint_truth"] == truth_log_joint(proposed.problem, table, WORDS)
    unknown = measured("csl", Learned(proposed, replace(table, truth_action=None)), WORDS)
    assert unknown["log_joint_truth"] is None
    assert unknown["log_joint"] == found["log_joint"]


def test_without_kept_states_measures_of_the_summary_are_empty(proposed: Fit, table: FeatureTable) -> None:
    measures = measured("csl", Learned(replace(proposed, history=None, summary=None), table), WORDS)
    empty = {name for name, value in measures.items() if value is None}
    without = {name for name in measures if name.endswith(("_low", "_high", "_summary", "_mode", "_entropy"))}
    assert empty == without | {"none_precision", "none_recall"}  # of no method that gives every word a channel
    assert len(empty) == 8 + 2 + 7 + 1 + 1 + 2


@pytest.mark.parametrize(("method", "words"), [("mmlda", True), ("proposed", False), ("gmm", False)])
def test_ear_is_empty_without_frames_or_words(table: FeatureTable, method: str, words: bool) -> None:
    measures = measured("csl", Learned(fit_of(table, method, words), table), WORDS)
    assert {measures[name] for name in ("EAR", "EAR_mode", "EAR_low", "EAR_high", "word_entropy")} == {None}


def test_score_files_keep_every_digit(out: Path) -> None:
    rows = score_rows({**CONDITION, **NUMBERS}, {"ARI_a": 0.1 + 0.2, "EAR": None})
    write_scores(rows, out / "a.csv")
    write_scores(score_rows({**CONDITION, **NUMBERS, "seed": 2}, {"ARI_a": 1 / 3}), out / "b.csv")
    write_csv(read_scores([out / "a.csv", out / "b.csv"]), out / "scores.csv")
    scores = read_scores([out / "scores.csv"])
    assert list(scores.columns) == COLUMNS
    assert scores["value"].tolist()[::2] == [0.1 + 0.2, 1 / 3]
    assert np.isnan(scores["value"][1])
    assert (out / "a.csv").read_text().splitlines()[2].endswith(",EAR,")


def test_a_file_with_other_columns_is_refused(out: Path) -> None:
    pd.DataFrame({"measure": ["EAR"]}).to_csv(out / "a.csv", index=False)
    with pytest.raises(ValueError, match=r"a\.csv: columns"):
        read_scores([out / "a.csv"])


def test_words_of_no_channel_count_as_any_other(table: FeatureTable) -> None:
    """Two words of each sentence are of no channel in truth; one in the fit, and another that is of a channel."""
    none = [*WORDS["action"], *WORDS["color"]]
    words = {channel: WORDS[channel] for channel in ("position", "object")} | {"none": none}
    open_fit = fit_of(table, "proposed_open")
    true_channel = {word: c for c, name in ((1, "position"), (2, "object")) for word in WORDS[name]}
    said = [open_fit.trials.vocabulary[w] for w in open_fit.trials.words[0]]
    right = np.array([true_channel.get(word, 4) for word in said])
    assert right.tolist().count(4) == len(right) / 2
    wrong = np.where([word in WORDS["action"] for word in said], 3, right)
    wrong = np.where([word in WORDS["object"] for word in said], 4, wrong)
    for F, expected in ((right, (1.0, 1.0, 1.0)), (wrong, (0.5, 0.5, 0.5))):
        learned = Learned(replace(open_fit, state=replace(open_fit.state, F=F)), table)
        measures = measured("csl", learned, words)
        assert (measures["EAR"], measures["none_precision"], measures["none_recall"]) == expected
