"""The collapsed Gibbs sampler: only z and F are sampled, one element and one sentence at a time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from model.samplers.base import Marginal, Temperature
from model.state import Partition

if TYPE_CHECKING:
    from model.problem import Problem


class Collapsed(Marginal):
    """Sweeps over z and F with π, φ and θ integrated out; ends with their posterior means."""

    annealing = 0.5
    kind: Literal["collapsed"] = "collapsed"
    temperature: Temperature = Field(
        default=1.0,
        description="where annealing starts; it falls linearly to 1 over the first half of the iterations; "
        "1 is no annealing",
    )

    def step(self, rng: np.random.Generator, problem: Problem, state: Partition, iteration: int) -> Partition:
        """Sweep once over each element of each channel, then over each sentence."""
        from model.kernels import collapsed_assignments as assignments
        from model.kernels import collapsed_frames as frames

        z, temperature = list(state.z), annealed(self.temperature, iteration, self.iterations)
        for c in range(len(z)):
            z[c] = assignments.sweep_assignments(rng, problem, c, z[c], state.F, temperature)
        return Partition(tuple(z), frames.sweep_frames(rng, problem, z, state.F, temperature))

    def power(self, iteration: int) -> float:
        """One over the temperature of the iteration, at which all densities are."""
        return 1.0 / annealed(self.temperature, iteration, self.iterations)


def annealed(temperature: float, iteration: int, iterations: int) -> float:
    """The temperature of an iteration 0, 1, …: from `temperature` linearly to 1 over the first half."""
    half = iterations // 2
    return 1.0 if iteration >= half else 1.0 + (temperature - 1.0) * (1.0 - iteration / half)
