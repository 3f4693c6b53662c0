"""The blocked Gibbs sampler, Algorithm 1 of the paper."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from model.samplers.base import Sampler
from model.state import State

if TYPE_CHECKING:
    from model.problem import Problem


class Blocked(Sampler[State]):
    """Algorithm 1 of the paper, and how the authors' program deviates from it (docs/model.md, The samplers)."""

    kind: Literal["blocked"] = "blocked"
    averaged_draws: int = Field(
        1,
        ge=1,
        description="θ and μ are means of this many draws: 1 is the published algorithm, 100 the authors' program; "
        "above 1 the kernel does not leave the posterior invariant",
    )
    empty_category: Literal["prior", "uniform"] = Field(
        "prior", description="where the mean of an empty category comes from: its prior, or uniformly the channel's box"
    )
    start_scale: float = Field(0.05, gt=0, description="Σ = start_scale · I at the start")

    @property
    def stream(self) -> str:
        """The name from which draws derive; averaged draws have their own."""
        return self.kind if self.averaged_draws == 1 else f"{self.kind}_averaged{self.averaged_draws}"

    def init(self, rng: np.random.Generator, problem: Problem) -> State:
        raise NotImplementedError

    def step(self, rng: np.random.Generator, problem: Problem, state: State, iteration: int) -> State:
        raise NotImplementedError

    def finish(self, problem: Problem, state: State) -> State:
        return state
