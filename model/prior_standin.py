"""Stands in for the coming `model.prior`."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Prior(BaseModel):
    """Hyperparameters of one channel."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    categories: int = Field(10, ge=1, le=1000, description="K, upper limit of the number of categories")
    concentration: float = Field(1.0, gt=0, description="α of the weights of the categories; small: few categories")
    mean: float = Field(0.0, description="m0")
    mean_precision: float = Field(0.001, gt=0, description="κ0: how firmly means are drawn towards m0")
    scale: float = Field(0.01, gt=0, description="V0 = scale · I: variance that a category is expected to have")
    extra_degrees_of_freedom: float = Field(2.0, gt=-1, description="ν0 − dim: how firmly it is")
    word_concentration: float = Field(
        0.1, gt=0, description="γ of the word distributions; small: few words per category"
    )
    box: Annotated[tuple[float, float], Field(strict=False)] = Field((0.0, 1.0), description="box")
