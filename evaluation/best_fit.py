"""Which of a condition's seeds is shown, and what is written over it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from model import METHODS, Fit, load


def by_log_joint(paths: Iterable[Path]) -> list[tuple[int, Fit]]:
    """The fits of a condition, the most probable first, each with its place (0, 1, …) in `paths`.

    Of equally probable ones the first in `paths` comes first.
    """
    fits = list(enumerate(load(path) for path in paths))
    return sorted(fits, key=lambda one: -float(one[1].trace_log_joint[-1]))


def title(condition: Mapping[str, object], fit: Fit, place: int, seeds: int) -> str:
    """Two lines that say which fit a figure shows.

    Args:
        condition: `experiment`, `variant`, `method`, `D` and `ROW`.
        fit: the fit.
        place: which of the seeds it is, from 0.
        seeds: how many there are.
    """
    K = {prior.categories for prior in fit.problem.priors}
    categories = f", K = {K.pop()}" if len(K) == 1 else ""
    method = METHODS[str(condition["method"])].label
    return (
        f"{condition['experiment']}, {method}, D = {condition['D']}, ROW {condition['ROW']} %{categories},\n"
        f"variant {condition['variant']}, seed {place + 1} of {seeds} (highest log joint)"
    )
