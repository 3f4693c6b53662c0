"""What all samplers share: how long they run, and the steps of a chain.

Samplers import their kernels inside their methods, so that a config can be checked without loading Numba.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Generic, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from model.state import Partition, State

if TYPE_CHECKING:
    from model.problem import Problem

S = TypeVar("S", bound=Partition)


class Sampler(BaseModel, ABC, Generic[S]):
    """A sampler with its settings; S is what its next step needs to know.

    Raises:
        ValueError: Settings are unknown or out of range; all of them are named at once.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    kind: str = ""  # each kind has its own
    iterations: int = Field(default=200, ge=1, le=1_000_000, description="sweeps per chain")
    chains: int = Field(
        default=1,
        ge=1,
        le=1000,
        description="number of chains; the one whose last state has the highest log p(X, w, z, F) is kept",
    )
    keep_history: int = Field(
        default=20,
        ge=0,
        le=1_000_000,
        description="number of states whose z and F are kept, evenly spaced up to the last; at most all",
    )

    @property
    def stream(self) -> str:
        """The name from which a study derives the draws of this sampler.

        Samplers that differ only in how long they run share it: 400 iterations begin as 200 do.
        """
        return self.kind

    @abstractmethod
    def init(self, rng: np.random.Generator, problem: Problem) -> S:
        """Return the first state of a chain."""

    @abstractmethod
    def step(self, rng: np.random.Generator, problem: Problem, state: S, iteration: int) -> S:
        """Return the state after one iteration; they are numbered from 0."""

    @abstractmethod
    def finish(self, problem: Problem, state: S) -> State:
        """Return the last state of a chain with π, φ and θ."""
