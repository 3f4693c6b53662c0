"""What figures are drawn from, and which of a condition's seeds is shown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from model import METHODS, Fit, load


@dataclass(frozen=True)
class Source:
    """What the rule `figure` gives to the function that draws a figure.

    Attributes:
        names: The experiment and, where the figure is drawn per method, the method.
        files: The inputs by name.
        settings: What else of the plan the figure shows, by name.
    """

    names: Mapping[str, str]
    files: Mapping[str, Sequence[Path]]
    settings: Mapping[str, Any]

    def most_probable(self) -> tuple[int, Fit, str]:
        """The fit of the highest log joint among `fits`, after its place among them and before its title."""
        place, fit = by_log_joint(self.files["fits"])[0]
        return place, fit, title(self.settings["condition"], fit, place, len(self.files["fits"]))


def by_log_joint(paths: Iterable[Path]) -> list[tuple[int, Fit]]:
    """The fits of a condition, the most probable first, each with its place (0, 1, …) in `paths`.

    Of equally probable ones the first in `paths` comes first.
    """
    fits = list(enumerate(load(path) for path in paths))
    return sorted(fits, key=lambda one: -float(one[1].trace_log_joint[-1]))


def title(condition: Mapping[str, object], fit: Fit, place: int, seeds: int) -> str:
    """Two lines that say which fit a figure shows.

    Args:
        condition: `experiment`, `variant`, `method`, `sampler`, `D` and `ROW`.
        fit: The fit.
        place: Which of the seeds it is, from 0.
        seeds: How many there are.
    """
    K = {prior.categories for prior in fit.problem.priors}
    categories = f", K = {K.pop()}" if len(K) == 1 else ""
    method = METHODS[str(condition["method"])].label
    return (
        f"{condition['experiment']}, {method}, D = {condition['D']}, ROW {condition['ROW']} %{categories},\n"
        f"variant {condition['variant']}, sampler {condition['sampler']}, "
        f"seed {place + 1} of {seeds} (highest log joint)"
    )
