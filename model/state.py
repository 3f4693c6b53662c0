"""The states of the samplers: what the next step needs, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from model.data import Floats, Ints


@dataclass(frozen=True)
class Partition:
    """One point of the posterior of z and F with all else integrated out; tuples hold one array per channel x.

    Attributes:
        z: (N_x,) category of each element.
        F: (T,) the channel of each word, their number C for none (∅); empty for a method without frames.
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
        log_words: (K_x, W) log θ^x; of a method with ∅ a last one, (1, W) log θ^∅.
        log_orders: (S,) log λ of each order of channels, in the order of `frame_paths.orders_of`, at its posterior
            mean given F: samplers integrate it out. Empty where it is not learned, and until a sampler ends.
    """

    log_weights: tuple[Floats, ...]
    mean: tuple[Floats, ...]
    factor: tuple[Floats, ...]
    log_words: tuple[Floats, ...]
    log_orders: Floats = field(default_factory=lambda: np.empty(0))
