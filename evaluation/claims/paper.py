"""The claims of the paper, as data. `evaluation.claims.verdicts` decides them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, product, starmap
from typing import Any

from evaluation.claims.judging import Cell, Comparison, Sum
from evaluation.scores import LETTERS

A, B, C, ALL = "proposed", "no_mec2", "mmlda", "gmm"
ARI = tuple(f"ARI_{letter}" for letter in LETTERS.values())
ONE = Sum(constant=1.0)
ACTION_WORDS = ("reach", "touch", "grasp", "look-at")
OTHER_WORLD = "Another world than the paper's robot: the simulated iCub under harder conditions."


@dataclass(frozen=True)
class Claim:
    """A claim of the paper.

    Attributes:
        number: Its number.
        text: What it says.
        experiment: The experiment that it is about.
        comparisons: All of them hold if the claim holds.
        paper: The value in the paper, where its text still has it.
        note: What to keep in mind when reading the verdict.
    """

    number: int
    text: str
    experiment: str
    comparisons: tuple[Comparison, ...]
    paper: str = ""
    note: str = ""


def confused(first: str, second: str) -> str:
    """The measure that counts how often two words are taken for each other (`verdicts.description_scores`)."""
    return f"confused {first}/{second}"


def _cell(experiment: str, D: int, ROW: int, method: str, measure: str) -> Sum:
    return Sum(((1.0, Cell(experiment, D, ROW, method, measure)),))


_sim, _real = partial(_cell, "simulator"), partial(_cell, "real")


def _gap(D: int, ROW: int) -> Sum:
    """EAR(A) − EAR(B) in the simulator."""
    return _sim(D, ROW, A, "EAR") - _sim(D, ROW, B, "EAR")


def _gain(D: int, measure: str) -> Sum:
    """What A gains from the words, against ALL, which hears none."""
    gain = _sim(D, 0, A, measure) - _sim(D, 100, ALL, measure)
    return replace(gain, name=f"gain of {measure} from ALL to A at ROW 0 (D {D})")


def _fall(first: str, second: str) -> Sum:
    """By how much F1 of the words of two channels falls at D = 20: the mean of the two channels."""
    signs = ((0.5, 0), (-0.5, 40))
    terms = ((sign, Cell("simulator", 20, ROW, A, f"F1_{c}")) for sign, ROW in signs for c in (first, second))
    return Sum(tuple(terms), name=f"fall of F1 of {first} and {second} words from ROW 0 to 40 (A, D 20)")


def _confusions(pair: tuple[str, str]) -> Sum:
    """How often two words are taken for each other in the four conditions of Figure 6."""
    terms = ((1.0, Cell("simulator", D, ROW, A, confused(*pair))) for D in (20, 40) for ROW in (0, 40))
    return Sum(tuple(terms), name=f"{confused(*pair)} (A, D 20 and 40, ROW 0 and 40)")


def _all(comparison: Callable[..., Comparison], *axes: Iterable[Any]) -> tuple[Comparison, ...]:
    """The comparison for each combination of values."""
    return tuple(starmap(comparison, product(*axes)))


def _methods(cell: Callable[..., Sum], sign: str, bound: float = 0.0) -> Callable[..., Comparison]:
    """A compared with another method, by D, ROW, measure and that method."""
    return lambda D, ROW, measure, other: Comparison(
        cell(D, ROW, A, measure), sign, cell(D, ROW, other, measure), bound
    )


PAIR, *OTHER_PAIRS = combinations(ACTION_WORDS, 2)
LEARNED = ("EAR", "ARI_p", "F1", "ACC")
Ds, ROWs = (20, 40), (0, 20, 40, 60)
REAL_Ds, REAL_ROWs = (25, 40), (0, 9, 20, 40)

CLAIMS = (
    Claim(
        1,
        "EAR(A) > EAR(B) in every (D, ROW) of the simulator",
        "simulator",
        _all(_methods(_sim, ">"), Ds, ROWs, ["EAR"], [B]),
    ),
    Claim(
        2,
        "EAR(A) − EAR(B) is larger at ROW 0 than at ROW 60, D = 20",
        "simulator",
        (Comparison(_gap(20, 0), ">", _gap(20, 60)),),
    ),
    Claim(
        3,
        "EAR(A) − EAR(B) is at most 0.05 at D = 20, ROW 40 and 60",
        "simulator",
        _all(_methods(_sim, "≤", 0.05), [20], (40, 60), ["EAR"], [B]),
        paper="about 0.02",
    ),
    Claim(
        4,
        "For A: EAR, ARI_p, F1 and ACC at ROW 0 are at least those at ROW 40, each D",
        "simulator",
        _all(lambda D, measure: Comparison(_sim(D, 0, A, measure), "≥", _sim(D, 40, A, measure)), Ds, LEARNED),
    ),
    Claim(
        5,
        "For A: EAR, ARI_p, F1 and ACC at D = 40 are at least those at D = 20, ROW 0",
        "simulator",
        _all(lambda measure: Comparison(_sim(40, 0, A, measure), "≥", _sim(20, 0, A, measure)), LEARNED),
    ),
    Claim(
        6,
        "From ALL to ROW 0, ARI_p gains most of the four ARI (A, each D)",
        "simulator",
        _all(lambda D, x: Comparison(_gain(D, "ARI_p"), ">", _gain(D, x)), Ds, [x for x in ARI if x != "ARI_p"]),
    ),
    Claim(
        7,
        "ARI_c ≥ 0.95 at D = 40, ROW 0 (A)",
        "simulator",
        (Comparison(_sim(40, 0, A, "ARI_c"), "≥", Sum(constant=0.95)),),
        paper="color categories perfect in the example run",
    ),
    Claim(
        8,
        "ARI_o and ARI_a are below ARI_c at D = 40, ROW 0 (A)",
        "simulator",
        _all(lambda x: Comparison(_sim(40, 0, A, "ARI_c"), ">", _sim(40, 0, A, x)), ("ARI_o", "ARI_a")),
    ),
    Claim(
        9,
        "OAR(A) = 1 in the simulator; OAR and WAR of A are at least those of B and C",
        "simulator",
        (
            Comparison(_sim(40, 0, A, "OAR"), "=", ONE),
            *_all(_methods(_sim, "≥"), [40], [0], ("OAR", "WAR"), (B, C)),
        ),
        paper="OAR of A 1.000",
        note="The paper asked eight people for the words of WAR; here the tutor's criteria decide.",
    ),
    Claim(
        10,
        "F1 and ACC of A are above those of B and C, each D, ROW 0",
        "simulator",
        _all(_methods(_sim, ">"), Ds, [0], ("F1", "ACC"), (B, C)),
    ),
    Claim(
        11,
        "Reach / touch is the pair of action words most often confused",
        "simulator",
        _all(lambda other: Comparison(_confusions(PAIR), ">", _confusions(other)), OTHER_PAIRS),
        note="Counts of both directions, in the matrices of the paper's Figure 6: D 20 and 40, ROW 0 and 40, A. "
        "Where a word is true of no test action, confusions with it are counted in one direction only.",
    ),
    Claim(
        12,
        "At D = 20, F1 of action and position words falls more from ROW 0 to 40 than that of object and color words",
        "simulator",
        (Comparison(_fall("action", "position"), ">", _fall("object", "color")),),
        note="F1 of a channel: the mean over its words; a word said for one of another channel counts against it.",
    ),
    Claim(
        13,
        "|ARI_x(A) − ARI_x(B)| and |ARI_x(A) − ARI_x(C)| ≤ 0.1 for every channel, D and ROW, and EAR(A) > EAR(B)",
        "real",
        (
            *_all(_methods(_real, "within ±", 0.1), REAL_Ds, REAL_ROWs, ARI, (B, C)),
            *_all(_methods(_real, ">"), REAL_Ds, REAL_ROWs, ["EAR"], [B]),
        ),
        note=OTHER_WORLD,
    ),
    Claim(
        14,
        "OAR(A) = OAR(B) = 1, and OAR(C) is lower",
        "real",
        (
            *_all(lambda method: Comparison(_real(25, 0, method, "OAR"), "=", ONE), (A, B)),
            *_all(_methods(_real, ">"), [25], [0], ["OAR"], [C]),
        ),
        paper="OAR 1.000, 1.000 and 0.833",
        note=f"{OTHER_WORLD} The paper's 0.833 for C may come from its program.",
    ),
)
