"""Elements that no sentence speaks of: Gibbs, one element at a time."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled, lean
from model.distributions.dirichlet import draw_index
from model.kernels.mixing.counts import element_log_weights
from model.kernels.mixing.gaussians import attach, detach
from model.kernels.mixing.setup import Setup, Tables


@compiled
def sweep_silent(rng: np.random.Generator, setup: Setup, tables: Tables) -> None:
    """Draw z of each silent element from p(z_i = k | …) ∝ (n_k + α/K) · p(x_i | k)."""
    for c in range(len(setup.size)):
        for i in range(setup.size[c]):
            if setup.owner[c, i] < 0:
                move(setup, tables, c, i, draw_index(rng, element_log_weights(setup, tables, c, i)))


@lean
def move(setup: Setup, tables: Tables, c: int, i: int, k: int) -> None:
    """Give element i to category k, without its words."""
    if tables.z[c, i] != k:
        detach(setup, tables, c, i)
        attach(setup, tables, c, k, i)
