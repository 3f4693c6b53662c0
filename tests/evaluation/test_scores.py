"""Measures of fits, and the file that they are kept in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from evaluation.measures import Learned, measured
from evaluation.scores import COLUMNS, read_scores, score_rows, write_csv, write_scores
from features.table import FeatureTable
from model import Fit
from tests.evaluation.conftest import fit_of
from tests.synthetic import WORDS

CONDITION = {"experiment": "own", "variant": "default", "task": "csl", "method": "proposed", "sampler": "published"}
NUMBERS = {"D": 12, "ROW": 0, "seed": 1}


def perfect(fit: Fit, table: FeatureTable) -> Fit:
    """The fit with the truth in place of what was estimated."""
    truths = [getattr(table, f"truth_{channel.name}") for channel in fit.trials.channels]
    z = tuple(np.unique(truth, return_inverse=True)[1] for truth in truths)
    channel = {word: c for c, name in enumerate(WORDS) for word in WORDS[name]}
    F = np.array([channel[fit.trials.vocabulary[w]] for w in fit.trials.words[0]])
    return replace(fit, state=replace(fit.state, z=z, F=F))


def test_the_truth_scores_one(proposed: Fit, table: FeatureTable) -> None:
    measures = measured("csl", Learned(perfect(proposed, table), table), WORDS)
    assert {name: value for name, value in measures.items() if name.startswith(("ARI", "EAR"))} == dict.fromkeys(
        ("ARI_a", "ARI_p", "ARI_o", "ARI_c", "ARI_p_attended", "ARI_o_attended", "ARI_c_attended", "EAR"), 1.0
    )
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


@pytest.mark.parametrize(("method", "words"), [("mmlda", True), ("proposed", False), ("gmm", False)])
def test_ear_is_empty_without_frames_or_words(table: FeatureTable, method: str, words: bool) -> None:
    assert measured("csl", Learned(fit_of(table, method, words), table), WORDS)["EAR"] is None


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
