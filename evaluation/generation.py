"""The action generation task (sections 3.4 and 4.3 of the paper): the robot does what it is told."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from evaluation.scores import write_csv
from features.table import FeatureTable
from model import Fit
from model.data import Floats
from model.prediction import Answer, understand


def objects_of(table: FeatureTable, row: int) -> dict[str, Floats]:
    """The features (M, dim) of the objects of a table's trial, by channel."""
    own = table.trial_index == row
    return {"position": table.position[own], "object": table.object_feature[own], "color": table.color[own]}


def answers(fit: Fit, table: FeatureTable) -> tuple[Answer, ...]:
    """How the robot understands each instruction of a table; the instructed object is not looked at."""
    return tuple(understand(fit, objects_of(table, d), table.words[d]) for d in range(len(table.trial)))


def write_answers(table: FeatureTable, answered: Sequence[Answer], judged: Sequence[str | None], path: Path) -> None:
    """Write a row per instruction: what was asked, what was chosen, and what happened.

    `object_right` is 1 or 0, or between where choices are tied (in expectation), empty where the instructed object is
    not known; `action` is the true word of the instruction, `judged` the tutor's word for what the robot did, empty
    where nothing was executed.
    """
    rows = [
        {
            "trial": int(table.trial[d]),
            "instruction": " ".join(table.words[d]),
            "ignored": " ".join(answer.ignored),
            "objects": len(answer.log_scores),
            "instructed": instructed,
            "chosen": " ".join(sorted({str(m) for m, _ in answer.choices()})),
            "category": " ".join(sorted({str(k) for _, k in answer.choices()})),
            "object_right": np.mean([m == instructed for m, _ in answer.choices()]) if instructed >= 0 else None,
            "action": table.truth_action[d] if table.truth_action else None,
            "judged": judged[d],
        }
        for d, (answer, instructed) in enumerate(zip(answered, table.attended_object.tolist(), strict=True))
    ]
    write_csv(pd.DataFrame(rows), path)


def write_distributions(table: FeatureTable, answered: Sequence[Answer], path: Path) -> None:
    """Write the whole distribution of each answer: a row for each instruction, object and action category."""
    rows = [
        {
            "trial": int(table.trial[d]),
            "instruction": " ".join(table.words[d]),
            "instructed": int(table.attended_object[d]),
            "object": m,
            "category": k,
            "log_score": answer.log_scores[m, k],
            "probability": answer.probabilities[m, k],
        }
        for d, answer in enumerate(answered)
        for m, k in np.ndindex(answer.log_scores.shape)
    ]
    write_csv(pd.DataFrame(rows), path)


def read_answers(path: Path) -> pd.DataFrame:
    """Read what `write_answers` wrote."""
    return pd.read_csv(path, dtype={"chosen": str, "category": str, "action": str, "judged": str})
