"""Where chains start (docs/model.md, The samplers)."""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints
from model.distributions.dirichlet import draw_index

_ROUNDS = 10


@compiled
def k_means(rng: np.random.Generator, points: Floats, K: int) -> tuple[Floats, Ints]:
    """Centres (K, dim) of the points (N, dim) by k-means++ and ten rounds of Lloyd's algorithm, and the nearest (N,).

    Where there are fewer different points than K, points are repeated as centres. Own code, since SciPy's would
    double the time in which a fit starts.
    """
    N, dim = points.shape
    centres, nearest, distance = np.empty((K, dim)), np.zeros(N, dtype=np.int64), np.full(N, np.inf)
    for k in range(K):
        log_weights = np.zeros(N)
        if k > 0 and distance.max() > 0.0:
            log_weights = np.log(distance)
        centres[k] = points[draw_index(rng, log_weights)]
        _compare(points, centres, k, nearest, distance)
    for _ in range(_ROUNDS):
        total, count = np.zeros((K, dim)), np.zeros(K)
        for n in range(N):
            total[nearest[n]] += points[n]
            count[nearest[n]] += 1.0
        distance[:] = np.inf
        for k in range(K):
            if count[k] > 0.0:  # A centre that is nearest to no point stays where it is.
                centres[k] = total[k] / count[k]
            _compare(points, centres, k, nearest, distance)
    return centres, nearest


@compiled
def _compare(points: Floats, centres: Floats, k: int, nearest: Ints, distance: Floats) -> None:
    """Let points that are nearer to centre k than `distance` (N,), squared, know."""
    for n in range(len(points)):
        square = 0.0
        for j in range(points.shape[1]):
            square += (points[n, j] - centres[k, j]) ** 2
        if square < distance[n]:
            distance[n], nearest[n] = square, k


def stick_breaking(rng: np.random.Generator, concentration: float, K: int) -> Floats:
    """(K,) log π from GEM(α) cut off after K pieces and normalised."""
    pieces = np.maximum(rng.beta(1.0, concentration, size=K), np.finfo(np.float64).tiny)
    rest = np.maximum(1.0 - pieces[:-1], np.finfo(np.float64).tiny)
    log_weights = np.log(pieces) + np.concatenate([[0.0], np.cumsum(np.log(rest))])
    top = float(log_weights.max())
    return np.asarray(log_weights - (top + math.log(float(np.sum(np.exp(log_weights - top))))))
