"""The claims of the paper, as data. `evaluation.claims.verdicts` decides them."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

from evaluation.claims.judging import Comparison, Sum
from evaluation.claims.terms import (
    ACTION_WORDS,
    ARI,
    FIGURE_8,
    ONE,
    OTHER_WORLD,
    A,
    B,
    C,
    Claim,
    confusions,
    every,
    fall,
    gain,
    gap,
    lead,
    methods,
    real,
    share_of,
    sim,
)

PAIR, *OTHER_PAIRS = combinations(ACTION_WORDS, 2)
LEARNED = ("EAR", "ARI_p", "F1", "ACC")
Ds, ROWs = (20, 40), (0, 20, 40, 60)
REAL_Ds, REAL_ROWs = (25, 40), (0, 9, 20, 40)

# K of the study, above which no number of categories in use lies.
MOST_CATEGORIES = 10


def _more_often(experiment: str, Ds: tuple[int, int]) -> Callable[[tuple[str, str]], Comparison]:
    """Reach and touch are confused more often than another pair."""
    return lambda other: Comparison(confusions(experiment, Ds, PAIR), ">", confusions(experiment, Ds, other))


CLAIMS = (
    Claim(
        1,
        "EAR(A) > EAR(B) in every (D, ROW) of the simulator",
        every(methods(sim, ">"), Ds, ROWs, ["EAR"], [B]),
    ),
    Claim(
        2,
        "EAR(A) − EAR(B) is larger at ROW 0 than at ROW 60, D = 20",
        (Comparison(gap(20, 0), ">", gap(20, 60)),),
    ),
    Claim(
        3,
        "EAR(A) − EAR(B) is at most 0.05 at D = 20, ROW 40 and 60",
        every(methods(sim, "≤", 0.05), [20], (40, 60), ["EAR"], [B]),
        paper="about 0.02",
    ),
    Claim(
        4,
        "For A: EAR, ARI_p, F1 and ACC at ROW 0 are at least those at ROW 40, each D",
        every(lambda D, measure: Comparison(sim(D, 0, A, measure), "≥", sim(D, 40, A, measure)), Ds, LEARNED),
    ),
    Claim(
        5,
        "For A: EAR, ARI_p, F1 and ACC at D = 40 are at least those at D = 20, ROW 0",
        every(lambda measure: Comparison(sim(40, 0, A, measure), "≥", sim(20, 0, A, measure)), LEARNED),
    ),
    Claim(
        6,
        "From ALL to ROW 0, ARI_p gains most of the four ARI (A, each D)",
        every(lambda D, x: Comparison(gain(D, "ARI_p"), ">", gain(D, x)), Ds, [x for x in ARI if x != "ARI_p"]),
    ),
    Claim(
        7,
        "ARI_c ≥ 0.95 at D = 40, ROW 0 (A)",
        (Comparison(sim(40, 0, A, "ARI_c"), "≥", Sum(constant=0.95)),),
        paper="color categories perfect in the example run",
    ),
    Claim(
        8,
        "ARI_o and ARI_a are below ARI_c at D = 40, ROW 0 (A)",
        every(lambda x: Comparison(sim(40, 0, A, "ARI_c"), ">", sim(40, 0, A, x)), ("ARI_o", "ARI_a")),
    ),
    Claim(
        9,
        "OAR(A) = 1 in the simulator; OAR and WAR of A are at least those of B and C",
        (
            Comparison(sim(40, 0, A, "OAR"), "=", ONE),
            *every(methods(sim, "≥"), [40], [0], ("OAR", "WAR"), (B, C)),
        ),
        paper="OAR of A 1.000",
        note="The paper asked eight people for the words of WAR; here the tutor's criteria decide.",
    ),
    Claim(
        10,
        "F1 and ACC of A are above those of B and C, each D, ROW 0",
        every(methods(sim, ">"), Ds, [0], ("F1", "ACC"), (B, C)),
    ),
    Claim(
        11,
        "Reach / touch is the pair of action words most often confused",
        every(_more_often("simulator", Ds), OTHER_PAIRS),
        note="Counts of both directions, in the matrices of the paper's Figure 6: D 20 and 40, ROW 0 and 40, A. "
        "Where a word is true of no test action, confusions with it are counted in one direction only.",
    ),
    Claim(
        12,
        "At D = 20, F1 of action and position words falls more from ROW 0 to 40 than that of object and color words",
        (Comparison(fall("action", "position"), ">", fall("object", "color")),),
        note="F1 of a channel: the mean over its words; a word said for one of another channel counts against it.",
    ),
    Claim(
        13,
        "|ARI_x(A) − ARI_x(B)| and |ARI_x(A) − ARI_x(C)| ≤ 0.1 for every channel, D and ROW, and EAR(A) > EAR(B)",
        (
            *every(methods(real, "within ±", 0.1), REAL_Ds, REAL_ROWs, ARI, (B, C)),
            *every(methods(real, ">"), REAL_Ds, REAL_ROWs, ["EAR"], [B]),
        ),
        note=OTHER_WORLD,
    ),
    Claim(
        14,
        "OAR(A) = OAR(B) = 1, and OAR(C) is lower",
        (
            *every(lambda method: Comparison(real(25, 0, method, "OAR"), "=", ONE), (A, B)),
            *every(methods(real, ">"), [25], [0], ["OAR"], [C]),
        ),
        paper="OAR 1.000, 1.000 and 0.833",
        note=f"{OTHER_WORLD} The paper's 0.833 for C may come from its program.",
    ),
    Claim(
        15,
        "Position and color have as many categories in use as words, 4 and 3, at D = 40, ROW 0 (A)",
        tuple(
            Comparison(share_of(channel, words), ">", share_of(channel, used))
            for channel, words in (("position", 4), ("color", 3))
            for used in range(1, MOST_CATEGORIES + 1)
            if used != words
        ),
        paper="as many as words in the example run",
        note="The mode over the fits: more of them have that number than any other.",
    ),
    Claim(
        16,
        "ARI_o and ARI_a are below ARI_p at D = 40, ROW 0 (A)",
        every(lambda x: Comparison(sim(40, 0, A, "ARI_p"), ">", sim(40, 0, A, x)), ("ARI_o", "ARI_a")),
    ),
    Claim(
        17,
        "F1 and ACC of A are above those of B and C, each D, ROW 0",
        every(methods(real, ">"), REAL_Ds, [0], ("F1", "ACC"), (B, C)),
        note=OTHER_WORLD,
    ),
    Claim(
        18,
        "For A: EAR, F1 and ACC at D = 40 are at least those at D = 25, ROW 0",
        every(
            lambda measure: Comparison(real(40, 0, A, measure), "≥", real(25, 0, A, measure)), ("EAR", "F1", "ACC")
        ),
        note=OTHER_WORLD,
    ),
    Claim(
        19,
        "For A: the ARI of each channel changes by at most 0.1 from ROW 0 to ROW 40, each D",
        every(lambda D, x: Comparison(real(D, 0, A, x), "within ±", real(D, 40, A, x), 0.1), REAL_Ds, ARI),
        note=OTHER_WORLD,
    ),
    Claim(
        20,
        "Reach / touch is the pair of action words most often confused",
        every(_more_often("real", REAL_Ds), OTHER_PAIRS),
        note=f"{OTHER_WORLD} Counts of both directions, D 25 and 40, ROW 0 and 40, A, as in claim 11.",
    ),
    Claim(
        21,
        "Of the four channels, F1 of action and of object words differs most between A and C, each D, ROW 0",
        every(
            lambda D, one, other: Comparison(lead(D, one), ">", lead(D, other)),
            *(REAL_Ds, ("action", "object"), ("position", "color")),
        ),
        note=OTHER_WORLD,
    ),
    Claim(
        22,
        "In the fit of Figure 8 the two shades of green are categories of their own, and each says “green”",
        (Comparison(Sum(((1.0, FIGURE_8),)), "=", ONE),),
        paper="so in its one fit",
        note=f"{OTHER_WORLD} Of each data set the fit that the figure shows: A, K = 5, D 25, ROW 9, the seed with "
        "the highest log joint. A shade is a category of its own if most of its objects are in one, and most of "
        "those in it are of the shade.",
    ),
)
