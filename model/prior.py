"""The hyperparameters of a channel."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import BaseModel, ConfigDict, Field, field_validator

Positive = Annotated[float, Field(gt=0)]


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
    mean_precision: Positive = Field(default=0.001, description="κ0, the pseudo-observations behind m0")
    scale: Positive = Field(default=0.01, description="V0 = scale · I, the spread that the Gaussians expect")
    extra_degrees_of_freedom: float = Field(default=2.0, gt=-1, description="ν0 − dim")
    word_concentration: Positive = Field(default=0.1, description="γ of the word distributions")
    box: tuple[float, float] = Field(
        default=(0.0, 1.0),
        strict=False,
        description="interval from which the means of empty categories are drawn where `empty_category` is `uniform`",
    )

    @field_validator("box")
    @classmethod
    def _in_order(cls, box: tuple[float, float]) -> tuple[float, float]:
        if box[0] > box[1]:
            raise ValueError("the smaller number comes first")
        return box

    def gaussian(self, dim: int) -> GaussianPrior:
        """Return the prior of the Gaussians of a channel with features of `dim` numbers."""
        return GaussianPrior(
            float(self.mean),
            float(self.mean_precision),
            float(self.scale),
            float(dim + self.extra_degrees_of_freedom),
        )
