"""The table of uncertain instructions: the measures by kind of sentence."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from evaluation.catalogue import Table
from evaluation.scores import ROW_KEYS, UNITS
from evaluation.table_forms import Grid, Sheet
from evaluation.tables import over, readable, select, summarise
from evaluation.uncertain.answers import MEASURES, OPEN, by_seed
from evaluation.uncertain.instructions import KINDS

NOTE = (
    "What is averaged is each fit's mean over the sentences. An object fits when its true words contradict no word "
    "that is said. OAR among fitting: the chosen object is one that fits. Outvoted: the instructed object is chosen "
    "in spite of the wrong word. The entropy is that of the probability of the objects; a listener who knows the "
    "words has ln of the number of fitting objects. Means leave out sentences for which a measure is not defined: no "
    "object fits, or no word is wrong."
)


def summarise_uncertain(answered: pd.DataFrame) -> pd.DataFrame:
    """Mean, standard deviation and number of fits of each measure, by kind and condition.

    Returns:
        A row for each kind, in the order of `KINDS`, and condition, as `summarise` orders them; columns `kind`,
        those of `OPEN` (means over the sentences of all data sets, the same for every fit), and those of `summarise`.
    """
    means = by_seed(answered, "kind", MEASURES)
    sentences = answered.drop_duplicates(["dataset", "trial", "kind", "instruction"]).groupby("kind")
    known = sentences[[name for name in OPEN if name != "sentences"]].mean().assign(sentences=sentences.size())
    parts = []
    for kind in (kind for kind in KINDS if kind in known.index):
        scores = means[means["kind"] == kind].melt([*ROW_KEYS, *UNITS], [*MEASURES], "measure", "value")
        parts.append(summarise(scores, tuple(MEASURES)).assign(kind=kind))
    joined = pd.concat(parts, ignore_index=True).merge(known, left_on="kind", right_index=True)
    return joined[["kind", *OPEN, *(name for name in joined.columns if name not in ("kind", *OPEN))]]


def sheet_of_answers(answered: pd.DataFrame, table: Table) -> Sheet:
    """The table of the uncertain instructions of an experiment.

    Args:
        answered: The rows of all fits.
        table: The experiment, and the title.
    """
    own = select(answered, table)
    summary = summarise_uncertain(own)
    shown = readable(summary, tuple(MEASURES)).rename(columns=MEASURES)
    for place, (name, label) in enumerate(OPEN.items()):
        shown.insert(place, label, [_number(value) for value in summary[name]])
    shown.insert(0, "instruction", [KINDS[kind].label for kind in summary["kind"]])
    note = " ".join([over(own), NOTE, *_remarks(own)])
    return Sheet(table.title, (Grid(table.title, shown),), note, {".csv": summary}, table.experiment)


def _remarks(answered: pd.DataFrame) -> Iterator[str]:
    """What was left out of these answers: words, kinds of sentence, truth that is not known."""
    ignored = sorted({word for words in answered["ignored"].dropna() for word in words.split()})
    if ignored:
        yield f"Words that training never saw were left out: {', '.join(ignored)}."
    missing = [kind.label for name, kind in KINDS.items() if name not in set(answered["kind"])]
    if missing:
        yield f"The test set gives no sentence for: {'; '.join(missing)}."
    sentences = answered.drop_duplicates(["dataset", "trial", "kind", "instruction"])
    unknown = int(sentences["fitting"].isna().sum())
    if unknown:
        yield f"For {unknown} of {len(sentences)} sentences it is not known which objects fit."


def _number(value: float) -> str:
    return "–" if np.isnan(value) else f"{value:.3f}".rstrip("0").rstrip(".")
