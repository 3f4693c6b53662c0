"""How fits answer uncertain instructions, measured, and the table of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from data_collection.files import replacing
from evaluation.scores import write_csv
from evaluation.table_forms import Grid, text_forms
from evaluation.tables import ROW_KEYS, readable, summarise
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
NOTE = (
    "Mean ± standard deviation (n − 1) over the seeds of each seed's mean over the sentences; the data are the same "
    "for all seeds. An object fits when its true words contradict no word that is said. OAR among fitting: the "
    "chosen object is one that fits. Outvoted: the instructed object is chosen in spite of the wrong word. The "
    "entropy is that of the probability of the objects; a listener who knows the words has ln of the number of "
    "fitting objects. Means leave out sentences for which a measure is not defined: no object fits, or no word is "
    "wrong."
)


def measures_of(answer: Answer, instruction: Instruction) -> dict[str, float | None]:
    """Measure one answer; see docs/tasks.md for the definitions. A measure is None where it is not defined.

    Args:
        answer: the distribution over objects and action categories.
        instruction: what was said, and which objects fit.
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
        condition: the names of the fit.
        fit: what the robot learned.
        asked: the instructions.

    Returns:
        One row an instruction: condition, trial, kind, sentence, the words that training never saw and that were
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


def write_uncertain(rows: Iterable[Mapping[str, object]], path: Path) -> None:
    """Write the rows of all fits as CSV; a value that is not defined is an empty field."""
    write_csv(pd.DataFrame(list(rows)), path)


def read_uncertain(paths: Iterable[Path]) -> pd.DataFrame:
    """Read and join what `write_uncertain` wrote."""
    text = dict.fromkeys(("instruction", "ignored", "chosen"), str)
    return pd.concat([pd.read_csv(path, dtype=text) for path in paths], ignore_index=True)


def of_condition(answered: pd.DataFrame, condition: Mapping[str, object]) -> pd.DataFrame:
    """The rows of one variant, inference, D and ROW, with all methods and seeds."""
    same = [answered[key] == condition[key] for key in ("variant", "inference", "D", "ROW")]
    return answered[np.logical_and.reduce(same)]


def by_seed(answered: pd.DataFrame, group: str, measures: Iterable[str]) -> pd.DataFrame:
    """The mean of each measure for each fit and value of a column, one row each; measures as columns."""
    return answered.groupby([*ROW_KEYS, "seed", group], sort=False)[list(measures)].mean().reset_index()


def summarise_uncertain(answered: pd.DataFrame) -> pd.DataFrame:
    """Mean, standard deviation and number of seeds of each measure, by kind and condition.

    Returns:
        One row for each kind, in the order of `KINDS`, and condition, as `summarise` orders them; columns `kind`,
        those of `OPEN` (means over the sentences, the same for every fit), and those of `summarise`.
    """
    means = by_seed(answered, "kind", MEASURES)
    sentences = answered.drop_duplicates(["trial", "kind", "instruction"]).groupby("kind")
    known = sentences[[name for name in OPEN if name != "sentences"]].mean().assign(sentences=sentences.size())
    parts = []
    for kind in (kind for kind in KINDS if kind in known.index):
        scores = means[means["kind"] == kind].melt([*ROW_KEYS, "seed"], [*MEASURES], "measure", "value")
        parts.append(summarise(scores, tuple(MEASURES)).assign(kind=kind))
    joined = pd.concat(parts, ignore_index=True).merge(known, left_on="kind", right_index=True)
    return joined[["kind", *OPEN, *(name for name in joined.columns if name not in ("kind", *OPEN))]]


def render_uncertain(answered: pd.DataFrame, title: str, paths: Mapping[str, Path]) -> None:
    """Write the table of uncertain instructions in several forms, each to its path.

    Args:
        answered: the rows of all fits of an experiment.
        title: its heading.
        paths: by form: csv, md, tex, html.
    """
    summary = summarise_uncertain(answered)
    shown = readable(summary, tuple(MEASURES)).rename(columns=MEASURES)
    for place, (name, label) in enumerate(OPEN.items()):
        shown.insert(place, label, [_number(value) for value in summary[name]])
    shown.insert(0, "instruction", [KINDS[kind].label for kind in summary["kind"]])
    texts = text_forms(title, [Grid(title, shown)], " ".join([NOTE, *_remarks(answered)]))
    texts["csv"] = summary.to_csv(index=False, lineterminator="\n", float_format="%.6f")
    for form, path in paths.items():
        with replacing(path) as (temporary,):
            temporary.write_text(texts[form], encoding="utf-8")


def _remarks(answered: pd.DataFrame) -> Iterator[str]:
    """What was left out of these answers: words, kinds of sentence, truth that is not known."""
    ignored = sorted({word for words in answered["ignored"].dropna() for word in words.split()})
    if ignored:
        yield f"Words that training never saw were left out: {', '.join(ignored)}."
    missing = [kind.label for name, kind in KINDS.items() if name not in set(answered["kind"])]
    if missing:
        yield f"The test set gives no sentence for: {'; '.join(missing)}."
    sentences = answered.drop_duplicates(["trial", "kind", "instruction"])
    unknown = int(sentences["fitting"].isna().sum())
    if unknown:
        yield f"For {unknown} of {len(sentences)} sentences it is not known which objects fit."


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.3f}".rstrip("0").rstrip(".")
