"""The samplers by kind."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field


class _Settings(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    iterations: int = Field(200, ge=1, le=1_000_000, description="iterations; the last state is the result")
    chains: int = Field(
        1, ge=1, le=1000, description="chains per seed, of which the one with the highest log joint is kept"
    )
    keep_history: int = Field(
        20,
        ge=0,
        le=1_000_000,
        description="number of states, evenly spaced over the iterations, whose z and F a fit keeps for diagnostics",
    )


class Blocked(_Settings):
    """Algorithm 1 of the paper."""

    kind: Literal["blocked"] = "blocked"
    averaged_draws: int = Field(
        1,
        ge=1,
        le=10_000,
        description="draws whose mean replaces a draw of θ and μ; 1 is the algorithm as published, 100 the authors' program",
    )
    empty_category: Literal["prior", "uniform"] = Field(
        "prior", description="where the mean of an empty category is drawn from: its prior, or uniformly from the box"
    )
    start_scale: float = Field(0.05, gt=0, description="Σ = start_scale · I at the start")

    @property
    def stream(self) -> str:
        """The name from which the draws derive."""
        return "blocked" if self.averaged_draws == 1 else f"blocked_averaged{self.averaged_draws}"


class Collapsed(_Settings):
    """Parameters integrated out."""

    kind: Literal["collapsed"] = "collapsed"
    temperature: float = Field(
        1.0,
        ge=1,
        le=1_000_000,
        description="where annealing starts; it falls to 1 over the first half; 1 is no annealing",
    )

    @property
    def stream(self) -> str:
        """The name from which the draws derive."""
        return "collapsed"


SAMPLERS: dict[str, type[_Settings]] = {"blocked": Blocked, "collapsed": Collapsed}
AnySampler = Annotated[Blocked | Collapsed, Field(discriminator="kind")]
