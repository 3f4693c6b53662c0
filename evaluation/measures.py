"""Every measure of a fit. Its row here is all that scores, tables and their notes know of it."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from evaluation.learned import Learned
from evaluation.metrics import accuracy, f1_macro
from evaluation.scores import LETTERS, LOG_JOINT, LOG_JOINT_TRUTH, Words

# What a measure is taken of depends on its task; the words of the experiment come with it, by channel.
Value = Callable[[Any, Words], float | None]
# A measure of this name beside another is what chance would give.
CHANCE = "_chance"
# What is told of a fit and not to be maximised.
HIDDEN: Mapping[str, Any] = {"in_tables": False, "ranks": False}


@dataclass(frozen=True)
class Measure:
    """A measure of a fit.

    Attributes:
        task: `csl`, taken of what was `Learned`; `generation`, of what `generation.read_answers` gives;
            `description`, of what `description.describe_trials` gives.
        name: What `scores.csv` and tables call it.
        of: Its value; None where it is not defined.
        in_tables: Whether tables show it.
        optional: Whether they leave it out where no fit defines it, rather than say so.
        ranks: Whether it is the better the higher it is; tables neither mark nor compare others.
        chance: What chance would give; None where nobody asks.
        by_chance: What that is, as the notes of tables say it.
    """

    task: str
    name: str
    of: Value
    in_tables: bool = True
    optional: bool = False
    ranks: bool = True
    chance: Value | None = None
    by_chance: str = ""


# The channels of which not every element is attended to.
OBJECTS = {channel: x for channel, x in LETTERS.items() if channel != "action"}
Along = Callable[[Learned, Words], Sequence[float | None]]


def _by_channel(
    name: str, of: Callable[[Learned, str], float | None], channels: Mapping[str, str] = LETTERS, **settings: Any
) -> list[Measure]:
    """A measure of each channel; `name` has a place for its letter."""

    def value(channel: str, learned: Learned, words: Words) -> float | None:
        return of(learned, channel)

    return [Measure("csl", name.format(x), partial(value, channel), **settings) for channel, x in channels.items()]


def _interval(name: str, along: Along) -> list[Measure]:
    """The bounds of the 95 % credible interval of a measure, of which `along` gives the values in the kept states."""

    def bound(share: float, learned: Learned, words: Words) -> float | None:
        known = [value for value in along(learned, words) if value is not None]
        return float(np.quantile(known, share)) if known else None

    ends = {"low": 0.025, "high": 0.975}
    return [Measure("csl", f"{name}_{end}", partial(bound, share), **HIDDEN) for end, share in ends.items()]


def _ari_along(channel: str) -> Along:
    return lambda learned, words: learned.along[channel]


def _executed(answered: pd.DataFrame) -> pd.DataFrame:
    return answered.dropna(subset=["action", "judged"])


def _mean(values: Iterable[float]) -> float | None:
    """The mean; None of nothing."""
    known = list(values)
    return float(np.mean(known)) if known else None


MEASURES = (
    *_by_channel("ARI_{}", Learned.ari),
    *_by_channel("ARI_{}_attended", partial(Learned.ari, attended=True), OBJECTS, in_tables=False),
    *_by_channel("ARI_{}_summary", partial(Learned.ari, summary=True), in_tables=False),
    *_by_channel(
        "ARI_{}_attended_summary", partial(Learned.ari, summary=True, attended=True), OBJECTS, in_tables=False
    ),
    *(one for channel, x in LETTERS.items() for one in _interval(f"ARI_{x}", _ari_along(channel))),
    Measure("csl", "EAR", Learned.ear),
    Measure("csl", "EAR_mode", Learned.ear_mode, optional=True),
    *_interval("EAR", Learned.ear_along),
    Measure("csl", "none_precision", Learned.none_precision, optional=True),
    Measure("csl", "none_recall", Learned.none_recall, optional=True),
    Measure("csl", "word_entropy", lambda learned, words: learned.word_entropy(), **HIDDEN),
    *_by_channel("used_{}", lambda learned, channel: float(len(np.unique(learned.categories(channel)))), **HIDDEN),
    Measure("csl", LOG_JOINT, lambda learned, words: learned.log_joint(), **HIDDEN),
    Measure("csl", LOG_JOINT_TRUTH, Learned.log_joint_truth, **HIDDEN),
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

# Those of the tables that are the better the higher they are.
COMPARED = tuple(one.name for one in MEASURES if one.in_tables and one.ranks)


def measured(task: str, subject: object, words: Words) -> dict[str, float | None]:
    """The measures of a fit in a task by name, and the levels of chance after them; None where not defined."""
    own = [measure for measure in MEASURES if measure.task == task]
    values = {measure.name: measure.of(subject, words) for measure in own}
    return values | {one.name + CHANCE: one.chance(subject, words) for one in own if one.chance is not None}


def shown(tasks: Sequence[str], defined: Collection[str] = ()) -> tuple[str, ...]:
    """The names of the measures that tables of some tasks show, task after task.

    Args:
        tasks: Which tasks.
        defined: The measures that some fit of the table defines; of the others, optional ones are left out.
    """
    own = [one for task in tasks for one in MEASURES if one.task == task and one.in_tables]
    return tuple(one.name for one in own if one.name in defined or not one.optional)


def ranked(names: Sequence[str]) -> tuple[str, ...]:
    """Those of some measures that are the better the higher they are."""
    return tuple(own.name for own in MEASURES if own.name in names and own.ranks)


def chance_note(names: Sequence[str]) -> str:
    """What chance would do, for those of some measures that have a level of chance; empty without."""
    told = [f"of {one.name}, {one.by_chance}" for one in MEASURES if one.name in names and one.by_chance]
    return f"Chance: {'; '.join(told)}." if told else ""
