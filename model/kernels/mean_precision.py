"""κ0 of the channels that learn it, drawn from its values given a state.

With the n points of a category of mean x̄ and scatter S about it,

    V_n = V0 + S + κ0 n / (κ0 + n) · (x̄ − m0)(x̄ − m0)ᵀ,   |V_n| = |V0 + S| · (1 + κ0 n / (κ0 + n) · q),

q = (x̄ − m0)ᵀ (V0 + S)⁻¹ (x̄ − m0), so that one factor of V0 + S per category gives p(X | z, κ0) for every κ0.
"""

from __future__ import annotations

import math

import numpy as np

from model.compiled import compiled
from model.data import Floats, Ints
from model.distributions.dirichlet import draw_index
from model.distributions.gaussians import set_scatter
from model.distributions.triangular import factorise, squared_length
from model.prior import GaussianPrior
from model.problem import Problem
from model.state import Partition, State


def draw_given_partition(rng: np.random.Generator, problem: Problem, state: Partition, power: float) -> Problem:
    """The problem with κ0 drawn given z, μ and Σ integrated out.

    Args:
        rng: The fit's generator.
        problem: Data, method and hyperparameters.
        state: z; its F makes no difference.
        power: To which the densities of the features are raised, 1 for the posterior.
    """
    drawn = list(problem.mean_precision)
    for c, (channel, prior) in enumerate(zip(problem.trials.channels, problem.priors, strict=True)):
        if len(prior.mean_precisions) > 1:
            values, K = np.array(prior.mean_precisions), prior.categories
            log_weights = features_log_marginals(channel.features, state.z[c], K, problem.gaussians[c], values)
            drawn[c] = values[draw_index(rng, power * log_weights)]
    return problem.given(drawn)


def draw_given_gaussians(rng: np.random.Generator, problem: Problem, state: State) -> Problem:
    """The problem with κ0 drawn given μ and Σ of all K categories, from μ ~ N(m0, Σ / κ0)."""
    drawn = list(problem.mean_precision)
    for c, prior in enumerate(problem.priors):
        if len(prior.mean_precisions) > 1:
            values = np.array(prior.mean_precisions)
            upper = np.ascontiguousarray(state.factor[c].transpose(0, 2, 1))
            square = sum(map(squared_length, upper, state.mean[c] - prior.mean))
            log_weights = 0.5 * (state.mean[c].size * np.log(values) - values * square)
            drawn[c] = values[draw_index(rng, log_weights)]
    return problem.given(drawn)


@compiled
def features_log_marginals(features: Floats, z: Ints, K: int, prior: GaussianPrior, values: Floats) -> Floats:
    """Log p(X | z, κ0) of a channel for each value of κ0, but for what is the same for all of them.

    Args:
        features: (N, dim) X.
        z: (N,) categories.
        K: How many categories there are.
        prior: GIW(m0, ·, V0, ν0).
        values: (G,) of κ0.

    Returns:
        (G,) logarithms.
    """
    dim = features.shape[1]
    result, centre, spread = np.zeros(len(values)), np.empty(dim), np.empty((dim, dim))
    for k in range(K):
        n = set_scatter(features, z, k, prior.scale, centre, spread)
        if n == 0:
            continue
        factorise(spread, prior.scale)
        q = squared_length(spread, centre - prior.mean)
        for g in range(len(values)):
            weight = values[g] / (values[g] + n)
            result[g] += 0.5 * dim * math.log(weight)
            result[g] -= 0.5 * (prior.degrees_of_freedom + n) * math.log(1.0 + n * weight * q)
    return result
