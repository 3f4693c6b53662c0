"""The states of the samplers: what the next step needs, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from model.data import Floats, Ints


@dataclass(frozen=True)
class Partition:
    """One point of the posterior of z and F, all else integrated out: the state of the collapsed sampler.

    Attributes:
        z: (N_x,) category of each element, one array a channel x.
        F: (T,) the channel of each word; empty for a method without frames.
    """

    z: tuple[Ints, ...]
    F: Ints


@dataclass(frozen=True)
class State:
    """One point of the joint posterior, the state of the blocked sampler; a tuple holds one array a channel x.

    Attributes:
        z: (N_x,) category of each element.
        log_weights: (K_x,) log π^x.
        mean: (K_x, dim_x) μ^x.
        factor: (K_x, dim_x, dim_x) lower Cholesky factor of Σ^x.
        log_words: (K_x, W) log θ^x.
        F: (T,) the channel of each word; empty for a method without frames.
    """

    z: tuple[Ints, ...]
    log_weights: tuple[Floats, ...]
    mean: tuple[Floats, ...]
    factor: tuple[Floats, ...]
    log_words: tuple[Floats, ...]
    F: Ints


@dataclass(frozen=True)
class Settings:
    """How the blocked sampler deviates from the published algorithm (docs/model.md, The two samplers).

    Attributes:
        averaged_draws: θ and μ are means of so many draws; 1 is the published algorithm, 100 the authors' program.
            Above 1 the kernel does not leave the posterior invariant.
        empty_category: where the mean of an empty category comes from: its prior, or uniformly the channel's box.
        start_scale: Σ = start_scale · I at the start.
    """

    averaged_draws: int = 1
    empty_category: str = "prior"
    start_scale: float = 0.05

    def __post_init__(self) -> None:
        if self.averaged_draws < 1:
            raise ValueError(f"averaged_draws = {self.averaged_draws} (must be at least 1)")
        if not 0 < self.start_scale < np.inf:
            raise ValueError(f"start_scale = {self.start_scale} (must be positive)")
        if self.empty_category not in ("prior", "uniform"):
            raise ValueError(f"empty_category = {self.empty_category!r} (must be prior or uniform)")
