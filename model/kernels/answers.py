"""Sums over the frames of an instruction, for every object and action category."""

from __future__ import annotations

import numpy as np

from model.compiled import compiled
from model.data import Floats
from model.distributions.dirichlet import log_total
from model.frame_paths import Paths
from model.kernels.frame_paths import path_log_sums


@compiled
def sums_of_answers(
    paths: Paths, spoken: int, action: Floats, objects: Floats, none: Floats, log_end: Floats
) -> Floats:
    """(M, K) log p(words | object, action category).

    Args:
        paths: The states.
        spoken: The number of the action channel.
        action: (K, N) log θ of the words under the action categories.
        objects: (C, M, N) log probability of each word for each object by channel; the action's row is not used.
        none: (N,) log θ of no channel.
        log_end: (S,) log prior of a frame by its last state.
    """
    C, M, N = objects.shape
    result, log_weights = np.empty((M, len(action))), np.empty((N, C + 1))
    for m in range(M):
        for n in range(N):
            log_weights[n, C] = none[n]
            for c in range(C):
                log_weights[n, c] = objects[c, m, n]
        for k in range(len(action)):
            for n in range(N):
                log_weights[n, spoken] = action[k, n]
            result[m, k] = log_total(path_log_sums(paths, log_weights)[N] + log_end)
    return result
