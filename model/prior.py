"""The hyperparameters of a channel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple


class GaussianPrior(NamedTuple):
    """The prior GIW(m0, κ0, V0, ν0) of a channel's Gaussians as numbers, V0 = scale · I.

    Attributes:
        mean: m0, the same in every dimension.
        strength: κ0.
        scale: V0 = scale · I.
        freedom: ν0.
    """

    mean: float
    strength: float
    scale: float
    freedom: float


@dataclass(frozen=True)
class Prior:
    """Hyperparameters of one channel, the paper's values as defaults (section 4.2.1).

    Attributes:
        categories: K, upper limit of the number of categories (weak limit).
        concentration: α of the mixture weights.
        mean: m0, the same number in every dimension.
        mean_strength: κ0, pseudo-observations behind m0.
        scale: V0 = scale · I.
        extra_freedom: ν0 − dim, more than −1.
        word_concentration: γ of the word distributions.
        box: interval from which the mean of an empty category is drawn where
            `empty_category` is `uniform`.
    """

    categories: int = 10
    concentration: float = 1.0
    mean: float = 0.0
    mean_strength: float = 0.001
    scale: float = 0.01
    extra_freedom: float = 2.0
    word_concentration: float = 0.1
    box: tuple[float, float] = (0.0, 1.0)

    def gaussian(self, dim: int) -> GaussianPrior:
        """The prior of the Gaussians of a channel with features of `dim` numbers."""
        return GaussianPrior(
            float(self.mean), float(self.mean_strength), float(self.scale), float(dim + self.extra_freedom)
        )

    def __post_init__(self) -> None:
        low, high = self.box
        wrong = [
            f"{name} = {value} (must be {allowed})"
            for name, value, allowed, fine in (
                ("categories", self.categories, "at least 1", self.categories >= 1),
                ("concentration", self.concentration, "positive", 0 < self.concentration < math.inf),
                ("mean", self.mean, "finite", math.isfinite(self.mean)),
                ("mean_strength", self.mean_strength, "positive", 0 < self.mean_strength < math.inf),
                ("scale", self.scale, "positive", 0 < self.scale < math.inf),
                ("extra_freedom", self.extra_freedom, "more than -1", -1 < self.extra_freedom < math.inf),
                ("word_concentration", self.word_concentration, "positive", 0 < self.word_concentration < math.inf),
                ("box", self.box, "two finite numbers, the smaller first", -math.inf < low <= high < math.inf),
            )
            if not fine
        ]
        if wrong:
            raise ValueError("hyperparameters: " + "; ".join(wrong))
