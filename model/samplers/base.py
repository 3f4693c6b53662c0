"""What all samplers share: how long they run, and the steps of a chain.

Samplers import their kernels inside their methods, so that a config can be checked without loading Numba.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Annotated, ClassVar, Generic, Literal, Self, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from model.state import Partition, State

if TYPE_CHECKING:
    from model.methods import Method
    from model.problem import Problem

S = TypeVar("S", bound=Partition)


Iterations = Annotated[int, Field(ge=1, le=1_000_000)]
Temperature = Annotated[float, Field(ge=1, le=1_000_000)]
Kept = Annotated[int, Field(ge=0, le=1_000_000)]


class Sampler(BaseModel, ABC, Generic[S]):
    """A sampler with its settings; S is what its next step needs to know.

    Raises:
        ValueError: Settings are unknown or out of range; all of them are named at once.
    """

    only_models: ClassVar[bool] = True  # whether it takes generative models only, see `Method.is_model`
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    kind: str = ""  # each kind has its own
    iterations: Iterations = Field(default=200, description="sweeps per chain")
    chains: int = Field(
        default=1,
        ge=1,
        le=1000,
        description="number of chains; the one whose last state has the highest log p(X, w, z, F) is kept",
    )
    keep_history: Kept = Field(
        default=20,
        description="number of states whose z and F are kept, evenly spaced up to the last; at most all",
    )
    burn_in: float = Field(
        default=0.5,
        ge=0,
        lt=1,
        description="share of the iterations left out at the start: summaries, averages and diagnostics are of those "
        "after it",
    )
    parameters: Literal["draw", "mean", "average"] = Field(
        default="draw",
        description="which π, φ and θ the tasks use: draw, those of the last state (where a sampler integrates them "
        "out, posterior means given its z and F); mean, posterior means at the summary of the kept states; average, "
        "posterior means given z and F of each kept state, at most 50 of them, over which scores are averaged",
    )

    @model_validator(mode="after")
    def _kept_states_are_of_the_posterior(self) -> Self:
        if self.parameters != "draw" and self.keep_history == 0:
            raise ValueError(f"parameters: {self.parameters} needs kept states (keep_history 1 or more)")
        if self.burn_in < self.annealed_share:
            raise ValueError(f"burn_in = {self.burn_in} would keep annealed states (at least {self.annealed_share})")
        return self

    @property
    def annealed_share(self) -> float:
        """The share of the iterations, at the start, that do not sample from the posterior."""
        return 0.0

    @property
    def stream(self) -> str:
        """The name from which a study derives the draws of this sampler.

        Samplers that differ only in how long they run share it: 400 iterations begin as 200 do.
        """
        return self.kind

    def takes(self, method: Method) -> bool:
        """Whether the sampler can fit a method."""
        return method.is_model or not self.only_models

    @abstractmethod
    def init(self, rng: np.random.Generator, problem: Problem) -> S:
        """Return the first state of a chain."""

    @abstractmethod
    def step(self, rng: np.random.Generator, problem: Problem, state: S, iteration: int) -> S:
        """Return the state after one iteration; they are numbered from 0."""

    def learn(self, rng: np.random.Generator, problem: Problem, state: S, iteration: int) -> Problem:
        """Return the problem with κ0 drawn for the channels that learn it, given a state, before an iteration."""
        from model.kernels.mean_precision import draw_given_partition

        return draw_given_partition(rng, problem, state, self.power(iteration))

    def power(self, iteration: int) -> float:
        """The power to which the densities of the features are raised in an iteration, 1 for the posterior."""
        return 1.0

    def log_joint(self, problem: Problem, state: S) -> float:
        """Return log p(X, w, z, F), and p(κ0) where it is learned; π, φ and θ integrated out."""
        from model.joint import log_marginal_joint

        return log_marginal_joint(problem, state)

    @abstractmethod
    def finish(self, problem: Problem, state: S) -> State:
        """Return the last state of a chain with π, φ and θ."""


class Marginal(Sampler[Partition]):
    """A sampler of z and F alone, π, φ and θ integrated out, whose chains may be annealed.

    They start at k-means, and end with the posterior means of π, φ and θ.
    """

    annealing: ClassVar[float]  # the share of the iterations after which annealing ends
    temperature: Temperature

    @property
    def annealed_share(self) -> float:
        """The share of the iterations with a temperature above 1."""
        return self.annealing if self.temperature > 1 else 0.0

    def init(self, rng: np.random.Generator, problem: Problem) -> Partition:
        """Return a state with z by k-means and F at random."""
        from model.kernels.start import k_means

        pairs = zip(problem.trials.channels, problem.priors, strict=True)
        z = tuple(k_means(rng, channel.features, prior.categories)[1] for channel, prior in pairs)
        return Partition(z, problem.frame_prior.draw(rng, problem.trials))

    def finish(self, problem: Problem, state: Partition) -> State:
        """Return the state with π, φ and θ at their posterior means."""
        from model.kernels.means import posterior_means

        return posterior_means(problem, state)
