"""How fits answer uncertain instructions, measured."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from evaluation.scores import ROW_KEYS, SHARED, UNITS
from evaluation.uncertain.instructions import KINDS, Instruction
from model import Fit
from model.data import Floats
from model.prediction import Answer, understand

# What a fit makes of an instruction, and what the instruction leaves open; by name, what tables call it.
MEASURES = {
    "OAR_fit": "OAR among fitting",
    "mass_fit": "probability of fitting",
    "entropy": "entropy (nats)",
    "outvoted": "outvoted",
}
OPEN = {
    "sentences": "sentences",
    "fitting": "fitting objects",
    "ln_fitting": "ln of fitting",
    "chance_fit": "chance of fitting",
    "chance_outvoted": "chance of outvoted",
}


def measures_of(answer: Answer, instruction: Instruction) -> dict[str, float | None]:
    """Measure one answer; see docs/tasks.md for the definitions. A measure is None where it is not defined.

    Args:
        answer: The distribution over objects and action categories.
        instruction: What was said, and which objects fit.
    """
    probability, chosen = object_probabilities(answer), [m for m, _ in answer.choices()]
    M, fits, instructed = len(probability), instruction.fits, instruction.scene.instructed
    count = None if fits is None else sum(fits)
    wrong = KINDS[instruction.kind].wrong and instructed is not None
    measured: dict[str, float | None] = {
        "objects": M,
        "fitting": count,
        "ln_fitting": float(np.log(count)) if count else None,
        "entropy": entropy(probability),
        "OAR_fit": float(np.mean([fits[m] for m in chosen])) if fits and count else None,
        "mass_fit": float(probability[list(fits)].sum()) if fits and count else None,
        "chance_fit": count / M if count else None,
        "outvoted": float(np.mean([m == instructed for m in chosen])) if wrong else None,
        "chance_outvoted": 1 / M if wrong else None,
    }
    return measured


def object_probabilities(answer: Answer) -> Floats:
    """(M,) p(A = m | words, objects), the action category summed out."""
    return np.asarray(answer.probabilities.sum(axis=1))


def entropy(probability: Floats) -> float:
    """−Σ p ln p in nats."""
    positive = probability[probability > 0]
    return float(max(0.0, -np.sum(positive * np.log(positive))))


def answer_uncertain(
    condition: Mapping[str, object], fit: Fit, asked: Sequence[Instruction]
) -> list[dict[str, object]]:
    """Let a fit answer uncertain instructions.

    Args:
        condition: The names of the fit.
        fit: What the robot learned.
        asked: The instructions.

    Returns:
        A row per instruction: condition, trial, kind, sentence, the words that training never saw and that were
        ignored, the most probable objects, and the measures.
    """
    rows = []
    for one in asked:
        answer = understand(fit, one.scene.features, one.words)
        rows.append(
            {
                **condition,
                "trial": one.scene.trial,
                "kind": one.kind,
                "instruction": " ".join(one.words),
                "ignored": " ".join(answer.ignored),
                "chosen": " ".join(sorted({str(m) for m, _ in answer.choices()})),
                **measures_of(answer, one),
            }
        )
    return rows


def read_uncertain(paths: Iterable[Path]) -> pd.DataFrame:
    """Read and join files of the rows of `answer_uncertain`; a column says which task they are of."""
    text = dict.fromkeys(("instruction", "ignored", "chosen"), str)
    return pd.concat([pd.read_csv(path, dtype=text) for path in paths], ignore_index=True).assign(task="uncertain")


def of_condition(answered: pd.DataFrame, condition: Mapping[str, object]) -> pd.DataFrame:
    """The rows of one variant, sampler, D and ROW, with all methods and seeds."""
    same = [answered[key] == condition[key] for key in SHARED]
    return answered[np.logical_and.reduce(same)]


def by_seed(answered: pd.DataFrame, group: str, measures: Iterable[str]) -> pd.DataFrame:
    """The mean of each measure for each fit and value of a column, a row each; measures as columns."""
    return answered.groupby([*ROW_KEYS, *UNITS, group], sort=False)[list(measures)].mean().reset_index()
