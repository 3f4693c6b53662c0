"""Comparisons of cells of the tables, decided by a bootstrap over the seeds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby

import numpy as np
import pandas as pd

from evaluation.differences import letter
from model.data import Floats

HOLDS, FAILS, OPEN, NOT_RUN = "holds", "does not hold", "not decidable", "not run"
RESAMPLES = 10_000
# Differences below this are rounding.
TINY = 1e-9


@dataclass(frozen=True, order=True)
class Cell:
    """A cell of a table: a measure of the fits of one condition.

    Attributes:
        experiment: The experiment.
        D: Number of trials.
        ROW: Rate of omitted words in per cent.
        method: The method.
        measure: A measure of `scores.csv`, or of `verdicts.description_scores`.
    """

    experiment: str
    D: int
    ROW: int
    method: str
    measure: str

    def __str__(self) -> str:
        return f"{self.measure}({letter(self.method)}, D {self.D}, ROW {self.ROW})"


@dataclass(frozen=True)
class Sum:
    """A weighted sum of cells, plus a constant; `name` is what people read instead of its terms."""

    terms: tuple[tuple[float, Cell], ...] = ()
    constant: float = 0.0
    name: str = ""

    def __str__(self) -> str:
        if self.name:
            return self.name
        text = f"{self.constant:g}" if self.constant or not self.terms else ""
        for weight, cell in self.terms:
            sign = "−" if weight < 0 else "+"
            size = "" if abs(weight) == 1 else f"{abs(weight):g} "
            text += f" {sign} {size}{cell}" if text else f"{'−' if weight < 0 else ''}{size}{cell}"
        return text

    def __sub__(self, other: Sum) -> Sum:
        negative = ((-weight, cell) for weight, cell in other.terms)
        return Sum((*self.terms, *negative), self.constant - other.constant)


# Whether a difference satisfies a relation to its bound; rounding never decides.
RELATIONS: dict[str, Callable[[float, float], bool]] = {
    ">": lambda difference, bound: difference > bound + TINY,
    "≥": lambda difference, bound: difference >= bound - TINY,
    "≤": lambda difference, bound: difference <= bound + TINY,
    "=": lambda difference, bound: abs(difference - bound) <= TINY,
    "within ±": lambda difference, bound: abs(difference) <= bound + TINY,
}


@dataclass(frozen=True)
class Comparison:
    """`left − right`, `relation`, `bound`: for example EAR(A) − EAR(B) > 0."""

    left: Sum
    relation: str
    right: Sum
    bound: float = 0.0

    def __str__(self) -> str:
        if self.bound:
            return f"{self.left - self.right} {self.relation} {self.bound:g}"
        return f"{self.left} {self.relation} {self.right}"

    @property
    def cells(self) -> list[Cell]:
        """Every cell that it rests on, once."""
        return list(dict.fromkeys(cell for _, cell in (self.left - self.right).terms))


@dataclass(frozen=True)
class Judgment:
    """What the data say of a comparison.

    Attributes:
        left, right: The two sums, means over the seeds; NaN where something was not run.
        difference: `left` − `right`.
        low, high: Its 95 % bootstrap interval.
        n: The smallest number of seeds that a part of it rests on.
        verdict: `holds`, `does not hold`, `not decidable` or `not run`.
    """

    left: float
    right: float
    difference: float
    low: float
    high: float
    n: int
    verdict: str


def judge(comparison: Comparison, values: Callable[[Cell], pd.Series[float]], rng: np.random.Generator) -> Judgment:
    """Decide a comparison.

    The point estimate over the seeds decides; where the 95 % percentile interval of 10,000 bootstrap samples of
    the seeds contains the bound, the comparison is not decidable. Within one experiment and D the cells are paired:
    fits of one seed hear the same words (those of a higher ROW a part of them), whatever the method. Between two D
    the seeds are drawn separately. Where all seeds give the same difference the interval is a point, and the point
    estimate alone decides: so `= 1` holds if every seed has 1. One seed alone leaves everything open.

    Args:
        comparison: What is compared.
        values: The defined values of a cell, by seed; empty where it was not run.
        rng: Draws the bootstrap samples.
    """
    parts = _parts(comparison, values)
    n = min(len(part) for part in parts)
    if n == 0:
        missing = float("nan")
        return Judgment(missing, missing, missing, missing, missing, 0, NOT_RUN)
    left, right = (
        float(total.constant + sum(part[side].mean() for part in parts))
        for side, total in (("left", comparison.left), ("right", comparison.right))
    )
    draws = np.full(RESAMPLES, comparison.left.constant - comparison.right.constant)
    for part in parts:
        draws += _resampled_means((part["left"] - part["right"]).to_numpy(), rng)
    low, high = (float(bound) for bound in np.quantile(draws, (0.025, 0.975)))
    verdict = _verdict(comparison, left - right, low, high) if n > 1 else OPEN
    return Judgment(left, right, left - right, low, high, n, verdict)


def combine(verdicts: list[str]) -> str:
    """The verdict on a claim that says that every one of its comparisons holds.

    One comparison that does not hold refutes it, whatever the others say or were not asked. Else it is not run if
    one of them was not, not decidable if one of them is not, and holds if all hold.
    """
    return next((verdict for verdict in (FAILS, NOT_RUN, OPEN) if verdict in verdicts), HOLDS)


def _parts(comparison: Comparison, values: Callable[[Cell], pd.Series[float]]) -> list[pd.DataFrame]:
    """The sums by seed, columns `left` and `right`, of each experiment and D, whose seeds are drawn separately."""
    sides = {"left": comparison.left, "right": comparison.right}
    parts = []
    for key, cells in groupby(sorted(comparison.cells), key=lambda cell: (cell.experiment, cell.D)):
        by_cell = pd.concat({cell: values(cell) for cell in cells}, axis=1).dropna().sort_index()
        part = pd.DataFrame(0.0, index=by_cell.index, columns=list(sides))
        for side, total in sides.items():
            for weight, cell in total.terms:
                if (cell.experiment, cell.D) == key:
                    part[side] += weight * by_cell[cell]
        parts.append(part)
    return parts


def _resampled_means(values: Floats, rng: np.random.Generator) -> Floats:
    return np.asarray(values[rng.integers(len(values), size=(RESAMPLES, len(values)))].mean(axis=1))


def _verdict(comparison: Comparison, difference: float, low: float, high: float) -> str:
    bounds = (-comparison.bound, comparison.bound) if comparison.relation == "within ±" else (comparison.bound,)
    if high - low > TINY and any(low - TINY <= bound <= high + TINY for bound in bounds):
        return OPEN
    return HOLDS if RELATIONS[comparison.relation](difference, comparison.bound) else FAILS
