"""The states of the samplers: what the next step needs, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass

from model.data import Floats, Ints


@dataclass(frozen=True)
class Partition:
    """One point of the posterior of z and F with all else integrated out; tuples hold one array per channel x.

    Attributes:
        z: (N_x,) category of each element.
        F: (T,) the channel of each word; empty for a method without frames.
    """

    z: tuple[Ints, ...]
    F: Ints


@dataclass(frozen=True)
class State(Partition):
    """One point of the joint posterior.

    Attributes:
        log_weights: (K_x,) log π^x.
        mean: (K_x, dim_x) μ^x.
        factor: (K_x, dim_x, dim_x) lower Cholesky factor of Σ^x.
        log_words: (K_x, W) log θ^x.
    """

    log_weights: tuple[Floats, ...]
    mean: tuple[Floats, ...]
    factor: tuple[Floats, ...]
    log_words: tuple[Floats, ...]
