"""The conditional distributions of the blocked Gibbs sampler, equations (11) to (25); those of θ are in `words`.

A conditional is right if it is proportional to the joint distribution, which the tests hold against each.
"""

from __future__ import annotations

import numpy as np

from model.compiled import compiled
from model.data import Flags, Floats, Ints
from model.distributions.dirichlet import draw_index, draw_log_dirichlet
from model.distributions.gaussian_densities import gaussian_log_density
from model.distributions.gaussians import draw_posterior_gaussians
from model.frame_paths import Paths
from model.frames import FrameList
from model.kernels.frame_paths import count_states, draw_path, end_log_weights, last_state
from model.prior import Prior
from model.problem import Problem
from model.state import State

# z^x: equations (21) to (24) of the paper's section 3.3


def assignment_log_weights(problem: Problem, c: int, state: State) -> Floats:
    """(N, K) unnormalised log p(z = k | …) of channel c: π_k N(x | μ_k, Σ_k) ∏ θ_{k,w}."""
    trials = problem.trials
    result = gaussian_log_density(trials.channels[c].features, state.mean[c], state.factor[c])
    explained = problem.explained(state.F, c)
    _add_words(result, state.log_weights[c], state.log_words[c], trials.words[c], trials.word_speaker[c], explained)
    return result


@compiled
def _add_words(
    result: Floats, log_weights: Floats, log_words: Floats, words: Ints, speaker: Ints, explained: Flags
) -> None:
    """Add log π to (N, K) log densities, and log θ of the explained words to their speakers' rows."""
    result += log_weights
    for t in range(len(words)):
        if explained[t]:
            for k in range(len(log_weights)):
                result[speaker[t], k] += log_words[k, words[t]]


# π^x


def weights_concentration(prior: Prior, z: Ints) -> Floats:
    """(1, K) parameters of π | z ~ Dir(α/K + n_1, …, α/K + n_K)."""
    K = prior.categories
    return np.asarray(prior.concentration / K + np.bincount(z, minlength=K)[None, :], dtype=np.float64)


def draw_weights(rng: np.random.Generator, prior: Prior, z: Ints) -> Floats:
    """Draw log π given z."""
    return np.asarray(draw_log_dirichlet(rng, weights_concentration(prior, z), 1)[0])


# φ^x = (μ^x, Σ^x)


def draw_categories(
    rng: np.random.Generator,
    problem: Problem,
    c: int,
    z: Ints,
    averaged_draws: int = 1,
    empty_category: str = "prior",
) -> tuple[Floats, Floats]:
    """Draw μ and the Cholesky factor of Σ of all K categories given z; settings as in `samplers.Blocked`."""
    K, features = problem.priors[c].categories, problem.trials.channels[c].features
    mean, factor = draw_posterior_gaussians(rng, features, z, K, averaged_draws, problem.gaussians[c])
    if empty_category == "uniform":
        empty = np.bincount(z, minlength=K) == 0
        mean[empty] = rng.uniform(*problem.priors[c].box, size=(int(empty.sum()), mean.shape[1]))
    return mean, factor


# F_d: equation (25)


def draw_frames(rng: np.random.Generator, problem: Problem, log_weights: Floats, F: Ints) -> Ints:
    """Draw F (T,) given `words.word_log_weights`: whole frames, or word by word where the prior factorises.

    Where λ is learned, each sentence's given the frames of all others, of which F are the present ones.
    """
    if not problem.frame_prior.has_frames:
        return np.empty(0, dtype=np.int64)
    trials, paths = problem.trials, problem.paths
    if paths is not None:
        return _draw_along_paths(rng, paths, log_weights, F, trials.sentence_bounds)
    return _draw_frames(rng, log_weights, trials.sentence_bounds, problem.frame_prior.listed(trials, 1))


@compiled
def _draw_frames(rng: np.random.Generator, log_weights: Floats, bounds: Ints, allowed: FrameList) -> Ints:
    """Draw F (T,) of the sentences with words bounds[d] to bounds[d + 1] − 1."""
    longest = allowed.frames.shape[1]
    F = np.empty(len(log_weights), dtype=np.int64)
    for d in range(len(bounds) - 1):
        for start in range(bounds[d], bounds[d + 1], longest):
            length = min(longest, bounds[d + 1] - start)
            chosen = draw_index(rng, _frame_log_weights(log_weights, start, length, allowed))
            for n in range(length):
                F[start + n] = allowed.frames[allowed.bounds[length] + chosen, n]
    return F


@compiled
def _draw_along_paths(rng: np.random.Generator, paths: Paths, log_weights: Floats, F: Ints, bounds: Ints) -> Ints:
    """Draw F (T,) sentence by sentence, words bounds[d] to bounds[d + 1] − 1."""
    F, counts = F.copy(), count_states(paths, F, bounds)
    for d in range(len(bounds) - 1):
        first, last = bounds[d], bounds[d + 1]
        counts[last_state(paths, F, first, last)] -= 1
        draw_path(rng, paths, log_weights[first:last], end_log_weights(paths, last - first, counts), F[first:last])
        counts[last_state(paths, F, first, last)] += 1
    return F


@compiled
def _frame_log_weights(log_weights: Floats, start: int, length: int, allowed: FrameList) -> Floats:
    """(frames,) unnormalised log probability of each frame of the words start to start + length − 1."""
    first, last = allowed.bounds[length], allowed.bounds[length + 1]
    result = np.zeros(last - first)
    for f in range(last - first):
        for n in range(length):
            result[f] += log_weights[start + n, allowed.frames[first + f, n]]
    return result
