"""What the claims of the paper are made of: cells of the tables, their sums, and lists of comparisons."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from itertools import product, starmap
from typing import Any

from evaluation.claims.judging import Cell, Comparison, Sum
from evaluation.scores import LETTERS

A, B, C, ALL = "proposed", "no_mec2", "mmlda", "gmm"
ARI = tuple(f"ARI_{letter}" for letter in LETTERS.values())
ONE = Sum(constant=1.0)
ACTION_WORDS = ("reach", "touch", "grasp", "look-at")
IS = " is "
# The fit of the paper's Figure 8, which has fewer categories, and the color of which it shows two shades.
SHADED_WORD = "green"
SHADES_APART = f"shades of {SHADED_WORD} apart"
FIGURE_8 = Cell("real", 25, 9, A, SHADES_APART, "few")
OTHER_WORLD = "Another world than the paper's robot: the simulated iCub under harder conditions."


@dataclass(frozen=True)
class Claim:
    """A claim of the paper.

    Attributes:
        number: Its number.
        text: What it says.
        comparisons: All of them hold if the claim holds.
        paper: The value in the paper, where its text still has it.
        note: What to keep in mind when reading the verdict.
    """

    number: int
    text: str
    comparisons: tuple[Comparison, ...]
    paper: str = ""
    note: str = ""

    @property
    def experiment(self) -> str:
        """The experiment that it is about."""
        return self.comparisons[0].cells[0].experiment


def confused(first: str, second: str) -> str:
    """The measure that counts how often two words are taken for each other (`verdicts.description_scores`)."""
    return f"confused {first}/{second}"


def exactly(measure: str, value: int) -> str:
    """The measure that is 1 where another has a value, else 0 (`verdicts.values_of`)."""
    return f"{measure}{IS}{value}"


def cell(experiment: str, D: int, ROW: int, method: str, measure: str) -> Sum:
    """A cell of the tables as a sum."""
    return Sum(((1.0, Cell(experiment, D, ROW, method, measure)),))


sim, real = partial(cell, "simulator"), partial(cell, "real")


def gap(D: int, ROW: int) -> Sum:
    """EAR(A) − EAR(B) in the simulator."""
    return sim(D, ROW, A, "EAR") - sim(D, ROW, B, "EAR")


def gain(D: int, measure: str) -> Sum:
    """What A gains from the words, against ALL, which hears none."""
    gain = sim(D, 0, A, measure) - sim(D, 100, ALL, measure)
    return replace(gain, name=f"gain of {measure} from ALL to A at ROW 0 (D {D})")


def fall(first: str, second: str) -> Sum:
    """By how much F1 of the words of two channels falls at D = 20: the mean of the two channels."""
    signs = ((0.5, 0), (-0.5, 40))
    terms = ((sign, Cell("simulator", 20, ROW, A, f"F1_{c}")) for sign, ROW in signs for c in (first, second))
    return Sum(tuple(terms), name=f"fall of F1 of {first} and {second} words from ROW 0 to 40 (A, D 20)")


def confusions(experiment: str, Ds: tuple[int, int], pair: tuple[str, str]) -> Sum:
    """How often two words are taken for each other in four conditions, those of Figure 6 in the simulator."""
    terms = ((1.0, Cell(experiment, D, ROW, A, confused(*pair))) for D in Ds for ROW in (0, 40))
    return Sum(tuple(terms), name=f"{confused(*pair)} (A, D {Ds[0]} and {Ds[1]}, ROW 0 and 40)")


def lead(D: int, channel: str) -> Sum:
    """How far A is above C in F1 of the words of a channel, `real`, ROW 0."""
    difference = real(D, 0, A, f"F1_{channel}") - real(D, 0, C, f"F1_{channel}")
    return replace(difference, name=f"F1 of {channel} words, A above C (D {D}, ROW 0)")


def share_of(channel: str, used: int) -> Sum:
    """In which share of the fits so many categories of a channel are in use, in the simulator."""
    share = sim(40, 0, A, exactly(f"used_{LETTERS[channel]}", used))
    return replace(share, name=f"share of fits with {used} {channel} categories (A, D 40, ROW 0)")


def every(comparison: Callable[..., Comparison], *axes: Iterable[Any]) -> tuple[Comparison, ...]:
    """The comparison for each combination of values."""
    return tuple(starmap(comparison, product(*axes)))


def methods(cell: Callable[..., Sum], sign: str, bound: float = 0.0) -> Callable[..., Comparison]:
    """A compared with another method, by D, ROW, measure and that method."""
    return lambda D, ROW, measure, other: Comparison(
        cell(D, ROW, A, measure), sign, cell(D, ROW, other, measure), bound
    )
