"""The collapsed Gibbs sampler: only z and F are sampled, one element and one sentence at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from model.samplers.base import Sampler
from model.state import Partition, State

if TYPE_CHECKING:
    from model.problem import Problem


class Collapsed(Sampler[Partition]):
    """Sweeps over z and F with π, φ and θ integrated out; ends with their posterior means."""

    kind: Literal["collapsed"] = "collapsed"
    temperature: float = Field(
        1.0,
        ge=1,
        description="where annealing starts; it falls linearly to 1 over the first half of the iterations; "
        "1 is no annealing",
    )

    def init(self, rng: np.random.Generator, problem: Problem) -> Partition:
        raise NotImplementedError

    def step(self, rng: np.random.Generator, problem: Problem, state: Partition, iteration: int) -> Partition:
        raise NotImplementedError

    def finish(self, problem: Problem, state: Partition) -> State:
        raise NotImplementedError
