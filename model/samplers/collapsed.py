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
        default=1.0,
        ge=1,
        le=1_000_000,
        description="where annealing starts; it falls linearly to 1 over the first half of the iterations; "
        "1 is no annealing",
    )

    @property
    def annealed_share(self) -> float:
        """Half of the iterations, with a temperature above 1."""
        return 0.5 if self.temperature > 1 else 0.0

    def init(self, rng: np.random.Generator, problem: Problem) -> Partition:
        """Return a state with z by k-means and F at random."""
        from model.kernels.start import k_means

        pairs = zip(problem.trials.channels, problem.priors, strict=True)
        z = tuple(k_means(rng, channel.features, prior.categories)[1] for channel, prior in pairs)
        return Partition(z, problem.frame_prior.draw(rng, problem.trials))

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

    def finish(self, problem: Problem, state: Partition) -> State:
        """Return the state with π, φ and θ at their posterior means."""
        from model.kernels.means import posterior_means

        return posterior_means(problem, state)


def annealed(temperature: float, iteration: int, iterations: int) -> float:
    """The temperature of an iteration 0, 1, …: from `temperature` linearly to 1 over the first half."""
    half = iterations // 2
    return 1.0 if iteration >= half else 1.0 + (temperature - 1.0) * (1.0 - iteration / half)
