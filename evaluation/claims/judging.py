"""Comparisons of cells of the tables, decided by a bootstrap over data sets and the seeds within them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby

import numpy as np
import pandas as pd

from evaluation.differences import letter
from evaluation.replicates import bootstrap, sets_needed, units
from evaluation.scores import UNITS

HOLDS, FAILS, OPEN, NOT_RUN = "holds", "does not hold", "not decidable", "not run"
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
        measure: A measure of `scores.csv`, of `verdicts.description_scores`, or `terms.SHADES_APART`.
        variant: The variant of its hyperparameters.
    """

    experiment: str
    D: int
    ROW: int
    method: str
    measure: str
    variant: str = "default"

    def __str__(self) -> str:
        other = "" if self.variant == "default" else f", {self.variant}"
        return f"{self.measure}({letter(self.method)}, D {self.D}, ROW {self.ROW}{other})"


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
        left, right: The two sums, means over the data sets of the means over their seeds; NaN where not run.
        difference: `left` − `right`.
        low, high: Its 95 % bootstrap interval.
        n: The smallest number of fits that a cell of a part of it rests on.
        datasets: The number of data sets.
        needed: Of what is not decidable, about how many data sets would decide it (`replicates.sets_needed`); else
            None.
        verdict: `holds`, `does not hold`, `not decidable` or `not run`.
    """

    left: float
    right: float
    difference: float
    low: float
    high: float
    n: int
    datasets: int
    needed: float | None
    verdict: str


def judge(comparison: Comparison, values: Callable[[Cell], pd.Series[float]], rng: np.random.Generator) -> Judgment:
    """Decide a comparison.

    The point estimate, over the data sets and the seeds within each, decides; where the 95 % percentile interval of
    hierarchical bootstrap samples (`replicates.bootstrap`) contains the bound, the comparison is not decidable.
    Within one experiment and D the cells are paired: fits of one data set and seed hear the same words (those of a
    higher ROW a part of them), whatever the method. Two D share the data sets, and their seeds are drawn separately.
    Where all fits give the same difference the interval is a point, and the point estimate alone decides: so `= 1`
    holds if every fit has 1. One seed of one data set leaves everything open.

    Args:
        comparison: What is compared; all cells are of one experiment.
        values: The defined values of a cell, indexed by `UNITS`; empty where it was not run.
        rng: Draws the bootstrap samples.
    """
    parts = _parts(comparison, values)
    n = min(len(part) for part in parts)
    if n == 0:
        missing = float("nan")
        return Judgment(missing, missing, missing, missing, missing, 0, 0, None, NOT_RUN)
    sets = parts[0].index.get_level_values(UNITS[0]).nunique()
    left, right = (
        float(total.constant + sum(units(part[side], sets > 1).mean() for part in parts))
        for side, total in (("left", comparison.left), ("right", comparison.right))
    )
    constant, apart = comparison.left.constant - comparison.right.constant, [p["left"] - p["right"] for p in parts]
    low, high = (float(bound) for bound in np.quantile(constant + bootstrap(apart, rng), (0.025, 0.975)))
    verdict = _verdict(comparison, left - right, low, high) if n > 1 else OPEN
    needed = None
    if verdict == OPEN and sets > 1:
        distance = min(abs(left - right - bound) for bound in _bounds(comparison))
        by_set = np.sum([np.asarray(units(part, True), dtype=np.float64) for part in apart], axis=0)
        needed = sets_needed(by_set, distance)
    return Judgment(left, right, left - right, low, high, n, sets, needed, verdict)


def combine(verdicts: list[str]) -> str:
    """The verdict on a claim that says that every one of its comparisons holds.

    One comparison that does not hold refutes it, whatever the others say or were not asked. Else it is not run if
    one of them was not, not decidable if one of them is not, and holds if all hold.
    """
    return next((verdict for verdict in (FAILS, NOT_RUN, OPEN) if verdict in verdicts), HOLDS)


def _parts(comparison: Comparison, values: Callable[[Cell], pd.Series[float]]) -> list[pd.DataFrame]:
    """The sums by `UNITS`, columns `left` and `right`, of each D, whose seeds are drawn separately.

    Only data sets that every D has are left.
    """
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
    if any(part.empty for part in parts):
        return parts
    sets = [part.index.get_level_values(UNITS[0]) for part in parts]
    common = set(sets[0]).intersection(*sets[1:])
    return [part[own.isin(common)] for part, own in zip(parts, sets, strict=True)]


def _bounds(comparison: Comparison) -> tuple[float, ...]:
    return (-comparison.bound, comparison.bound) if comparison.relation == "within ±" else (comparison.bound,)


def _verdict(comparison: Comparison, difference: float, low: float, high: float) -> str:
    if high - low > TINY and any(low - TINY <= bound <= high + TINY for bound in _bounds(comparison)):
        return OPEN
    return HOLDS if RELATIONS[comparison.relation](difference, comparison.bound) else FAILS
