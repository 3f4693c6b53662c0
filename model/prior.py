"""The hyperparameters of a channel."""

from __future__ import annotations

import math
from typing import Annotated, Literal, NamedTuple

from pydantic import AfterValidator, BaseModel, ConfigDict, Discriminator, Field, Tag

Positive = Annotated[float, Field(gt=0)]
LEARNED = "learned"
NumberOrLearned = Annotated[
    Annotated[Positive, Tag("number")] | Annotated[Literal["learned"], Tag("word")],
    Discriminator(lambda value: "word" if isinstance(value, str) else "number"),
]
# Values of a learned κ0 per power of ten.
_PER_DECADE = 10


def _in_order(interval: tuple[float, float]) -> tuple[float, float]:
    if interval[0] > interval[1]:
        raise ValueError("the smaller number comes first")
    return interval


class GaussianPrior(NamedTuple):
    """The prior GIW(m0, κ0, V0, ν0) of a channel's Gaussians as numbers, V0 = scale · I.

    Attributes:
        mean: m0, the same in every dimension.
        mean_precision: κ0.
        scale: V0 = scale · I.
        degrees_of_freedom: ν0.
    """

    mean: float
    mean_precision: float
    scale: float
    degrees_of_freedom: float


class Prior(BaseModel):
    """Hyperparameters of one channel, the paper's values as defaults (section 4.2.1).

    Raises:
        ValueError: Values are out of range; all of them are named at once.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    categories: int = Field(
        default=10, ge=1, le=1000, description="K, upper limit of the number of categories (weak limit)"
    )
    concentration: Positive = Field(default=1.0, description="α of the mixture weights")
    mean: float = Field(
        default=0.0, description="m0, the mean of the categories' means, the same number in every dimension"
    )
    mean_precision: NumberOrLearned = Field(
        default=0.001,
        description="κ0, the pseudo-observations behind m0; learned: drawn along with everything else, from "
        "`mean_precision_range`",
    )
    mean_precision_range: Annotated[tuple[Positive, Positive], AfterValidator(_in_order)] = Field(
        default=(1e-4, 10.0),
        strict=False,
        description="between which κ0 lies where it is learned: ten values per power of ten, alike in probability",
    )
    scale: Positive = Field(default=0.01, description="V0 = scale · I, the spread that the Gaussians expect")
    extra_degrees_of_freedom: float = Field(default=2.0, gt=-1, description="ν0 − dim")
    word_concentration: Positive = Field(default=0.1, description="γ of the word distributions")
    box: Annotated[tuple[float, float], AfterValidator(_in_order)] = Field(
        default=(0.0, 1.0),
        strict=False,
        description="interval from which the means of empty categories are drawn where `empty_category` is `uniform`",
    )

    @property
    def mean_precisions(self) -> tuple[float, ...]:
        """The values that κ0 can have, in rising order and alike in probability; one if it is not learned."""
        if self.mean_precision != LEARNED:
            return (float(self.mean_precision),)
        lowest, highest = map(math.log10, self.mean_precision_range)
        steps = max(1, round(_PER_DECADE * (highest - lowest)))
        # Six digits, so that the last digits of a library's powers make no difference.
        values = (10 ** (lowest + (highest - lowest) * step / steps) for step in range(steps + 1))
        return tuple(dict.fromkeys(float(f"{value:.6g}") for value in values))

    def gaussian(self, dim: int, mean_precision: float) -> GaussianPrior:
        """Return the prior of the Gaussians of a channel with features of `dim` numbers, given κ0."""
        return GaussianPrior(
            float(self.mean),
            mean_precision,
            float(self.scale),
            float(dim + self.extra_degrees_of_freedom),
        )
