"""Every measure of a fit. Its row here is all that scores, tables and their notes know of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from evaluation.metrics import accuracy, adjusted_rand_index, channel_by_word, estimation_accuracy_rate, f1_macro
from evaluation.scores import LETTERS
from features.table import FeatureTable
from model import Fit

Words = Mapping[str, Sequence[str]]
# What a measure is taken of depends on its task; the words of the experiment come with it, by channel.
Value = Callable[[Any, Words], float | None]
# A measure of this name beside another is what chance would give.
CHANCE = "_chance"


@dataclass(frozen=True)
class Measure:
    """A measure of a fit, the higher the better.

    Attributes:
        task: `csl`, taken of what was `Learned`; `generation`, of what `generation.read_answers` gives;
            `description`, of what `description.describe_trials` gives.
        name: What `scores.csv` and tables call it.
        of: Its value; None where it is not defined.
        in_tables: Whether tables show it.
        chance: What chance would give; None where nobody asks.
        by_chance: What that is, as the notes of tables say it.
    """

    task: str
    name: str
    of: Value
    in_tables: bool = True
    chance: Value | None = None
    by_chance: str = ""


@dataclass(frozen=True)
class Learned:
    """A fit, and the feature table that was fitted, with its truth where it is known."""

    fit: Fit
    table: FeatureTable

    def categories(self, channel: str) -> np.ndarray:
        """The estimated categories of a channel's elements."""
        return self.fit.state.z[self.fit.trials.index_of(channel)]


def _ari(channel: str, learned: Learned, words: Words) -> float | None:
    return adjusted_rand_index(learned.categories(channel), getattr(learned.table, f"truth_{channel}"))


def _ari_attended(channel: str, learned: Learned, words: Words) -> float | None:
    rows, truth = learned.table.attended_row, getattr(learned.table, f"truth_{channel}")
    known = None if truth is None else [truth[row] for row in rows]
    return adjusted_rand_index(learned.categories(channel)[rows], known)


def _ear(learned: Learned, words: Words) -> float | None:
    trials = learned.fit.trials
    channel_of = channel_by_word(words, [channel.name for channel in trials.channels])
    true = [channel_of.get(trials.vocabulary[w]) for w in trials.words[0]]
    return estimation_accuracy_rate(learned.fit.state.F, true) if learned.fit.problem.method.has_frames else None


def _used(channel: str, learned: Learned, words: Words) -> float:
    return float(len(np.unique(learned.categories(channel))))


def _executed(answered: pd.DataFrame) -> pd.DataFrame:
    return answered.dropna(subset=["action", "judged"])


def _mean(values: Iterable[float]) -> float | None:
    """The mean; None of nothing."""
    known = list(values)
    return float(np.mean(known)) if known else None


MEASURES = (
    *(Measure("csl", f"ARI_{x}", partial(_ari, channel)) for channel, x in LETTERS.items()),
    *(
        Measure("csl", f"ARI_{x}_attended", partial(_ari_attended, channel), in_tables=False)
        for channel, x in LETTERS.items()
        if channel != "action"
    ),
    Measure("csl", "EAR", _ear),
    *(Measure("csl", f"used_{x}", partial(_used, channel), in_tables=False) for channel, x in LETTERS.items()),
    Measure(
        "generation",
        "WAR",
        lambda answered, words: _mean(_executed(answered)["action"] == _executed(answered)["judged"]),
        chance=lambda answered, words: 1 / len(words["action"]) if len(_executed(answered)) else None,
        by_chance="an action that the tutor calls by each action word equally often (1 / number of action words)",
    ),
    Measure(
        "generation",
        "OAR",
        lambda answered, words: _mean(answered["object_right"].dropna()),
        chance=lambda answered, words: _mean(1 / answered.loc[answered["object_right"].notna(), "objects"]),
        by_chance="an object at random (the mean of 1 / number of objects over the instructions)",
    ),
    Measure("description", "F1", lambda told, words: f1_macro(list(told["true"]), list(told["described"]))),
    # The channel of each place in a sentence is given: a word at random from the whole vocabulary would do worse.
    Measure(
        "description",
        "ACC",
        lambda told, words: accuracy(list(told["true"]), list(told["described"])),
        chance=lambda told, words: _mean(1 / len(words[channel]) for channel in told["channel"]),
        by_chance="a word of the right channel at random (the mean of 1 / number of words of the channel over the "
        "words to say)",
    ),
)


def measured(task: str, subject: object, words: Words) -> dict[str, float | None]:
    """The measures of a fit in a task by name, and the levels of chance after them; None where not defined."""
    own = [measure for measure in MEASURES if measure.task == task]
    values = {measure.name: measure.of(subject, words) for measure in own}
    return values | {one.name + CHANCE: one.chance(subject, words) for one in own if one.chance is not None}


def shown(tasks: Sequence[str]) -> tuple[str, ...]:
    """The names of the measures that tables of some tasks show, task after task."""
    return tuple(own.name for task in tasks for own in MEASURES if own.task == task and own.in_tables)


def chance_note(names: Sequence[str]) -> str:
    """What chance would do, for those of some measures that have a level of chance; empty without."""
    told = [f"of {one.name}, {one.by_chance}" for one in MEASURES if one.name in names and one.by_chance]
    return f"Chance: {'; '.join(told)}." if told else ""
