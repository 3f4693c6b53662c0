"""Every measure of a fit, by task, and what tables say of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from evaluation import description, generation, learning
from evaluation.measure import Measure, Words

# In the order in which tables show them.
MEASURES: Mapping[str, tuple[Measure, ...]] = {
    "csl": learning.MEASURES,
    "generation": generation.MEASURES,
    "description": description.MEASURES,
}
# A measure of this name beside another is what chance would give.
CHANCE = "_chance"


def measured(task: str, subject: object, words: Words) -> dict[str, float | None]:
    """The measures of a fit in a task by name, and the levels of chance after them; None where not defined.

    Args:
        task: a key of `MEASURES`.
        subject: what the measures of this task are taken of.
        words: the words of the experiment by channel.
    """
    own = MEASURES[task]
    values = {measure.name: measure.of(subject, words) for measure in own}
    return values | {one.name + CHANCE: one.chance(subject, words) for one in own if one.chance is not None}


def shown(tasks: Iterable[str]) -> tuple[str, ...]:
    """The names of the measures that tables of some tasks show."""
    return tuple(measure.name for task in tasks for measure in MEASURES[task] if measure.in_tables)


def chance_note(names: Sequence[str]) -> str:
    """What chance would do, for those of some measures that have a level of chance; empty without."""
    every = (measure for own in MEASURES.values() for measure in own)
    told = [f"of {one.name}, {one.by_chance}" for one in every if one.name in names and one.chance is not None]
    return f"Chance: {'; '.join(told)}." if told else ""
