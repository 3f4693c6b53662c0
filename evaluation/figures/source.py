"""What figures are drawn from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from evaluation.best_fit import by_log_joint, title
from model import Fit


@dataclass(frozen=True)
class Source:
    """What the rule `figure` gives to the function that draws a figure.

    Attributes:
        names: the experiment and, where the figure is drawn per method, the method.
        files: the inputs by name.
        settings: what else of the plan the figure shows, by name.
    """

    names: Mapping[str, str]
    files: Mapping[str, Sequence[Path]]
    settings: Mapping[str, Any]

    def most_probable(self) -> tuple[int, Fit, str]:
        """The fit of the highest log joint among `fits`, after its place among them and before its title."""
        place, fit = by_log_joint(self.files["fits"])[0]
        return place, fit, title(self.settings["condition"], fit, place, len(self.files["fits"]))
