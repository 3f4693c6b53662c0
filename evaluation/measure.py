"""What a measure is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

# The words of an experiment, by channel.
Words = Mapping[str, Sequence[str]]
# What a measure is taken of depends on its task.
Value = Callable[[Any, Words], float | None]


@dataclass(frozen=True)
class Measure:
    """A measure of a fit, the higher the better.

    Attributes:
        name: what `scores.csv` and tables call it.
        of: its value; None where it is not defined.
        in_tables: whether tables show it.
        chance: what chance would give; None where nobody asks.
        by_chance: what that is, as the notes of tables say it.
    """

    name: str
    of: Value
    in_tables: bool = True
    chance: Value | None = None
    by_chance: str = ""
