"""What tests need around the samplers, and kernels that are broken on purpose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from model import METHODS, SAMPLERS, Prior, Problem, Sampler, State, Trials
from model.data import Floats, Ints
from model.distributions.dirichlet import count_log_marginal
from model.distributions.gaussian_densities import gaussian_log_marginal
from model.distributions.gaussians import gaussian_posterior
from model.joint import draw_data, draw_parameters
from model.kernels import collapsed_assignments, collapsed_frames, conditionals, words
from model.kernels.frame_paths import count_states
from model.kernels.words import none_counts, word_counts
from model.open_frames import Once
from model.state import Partition
from tests.synthetic import trials_of_model

Priors = tuple[Prior, ...]
# What no truth test can be about, and why: it has no posterior that a sampler could leave as it is.
NO_MODELS = {"mmlda_released": "F is drawn once and for all, z hears the words that F sends to it, θ hears all words"}
HEARING = [name for name, method in METHODS.items() if method.hears_words and name not in NO_MODELS]
# Every method that a kind can fit.
TAKEN = [(name, kind) for name, method in METHODS.items() for kind in SAMPLERS.values() if kind().takes(method)]
# Each kind without annealing, a kernel that leaves the posterior as it is. The moves that are many by default, for a
# study's data, are few: a sweep has all of them all the same, and a tiny model needs no more.
EXACT_SETTINGS = {"temperature": 1.0, "split_merge": 4, "group_moves": 4, "cluster_moves": 20}
EXACT: dict[str, Sampler[Any]] = {
    kind: sampler(**{name: value for name, value in EXACT_SETTINGS.items() if name in sampler.model_fields})
    for kind, sampler in SAMPLERS.items()
}


def tiny_trials(objects: list[int], lengths: list[int], W: int) -> Trials:
    """Trials with two channels: a two-dimensional action and a one-dimensional color."""
    trials = trials_of_model(np.random.default_rng(8), objects, lengths, W=W)
    vocabulary = tuple(f"word{i}" for i in range(W))
    words = np.tile(np.arange(sum(lengths)) % W, (2, 1))
    return replace(trials, channels=(trials.channels[0], trials.channels[2]), words=words, vocabulary=vocabulary)


@lru_cache
def moves_parameters(sampler: Sampler[Any]) -> bool:
    """Whether a sampler's states hold π, φ and θ."""
    problem = Problem.of(tiny_trials([1], [1], W=1), "mmlda")
    return isinstance(sampler.init(np.random.default_rng(0), problem), State)


def moved_by(sampler: Sampler[Any], state: State) -> Partition:
    """The part of a whole state that a sampler moves."""
    return state if moves_parameters(sampler) else Partition(state.z, state.F)


def redraw(rng: np.random.Generator, problem: Problem, state: Partition) -> Problem:
    """New data given a state; of one without parameters they come from their prior, which z and F do not touch."""
    if not isinstance(state, State):
        state = replace(draw_parameters(rng, problem), z=state.z, F=state.F)
    return draw_data(rng, problem, state)


def quantities(problem: Problem, state: Partition) -> Floats:
    """Label-free numbers of data and state, bounded or with light tails, of which each block moves some."""
    result: list[Any] = []
    for c, (channel, prior) in enumerate(zip(problem.trials.channels, problem.priors, strict=True)):
        z, x, K = state.z[c], channel.features[:, 0], prior.categories
        pairs = np.triu_indices(len(z), 1)
        same, close = (z[:, None] == z)[pairs], (np.abs(x[:, None] - x) < 0.5)[pairs]
        mine, counts, words = (
            problem.explained(state.F, c),
            word_counts(problem, c, z, state.F),
            problem.trials.words[c],
        )
        posterior = gaussian_posterior(channel.features, z, K, problem.gaussians[c])
        emission = gaussian_log_marginal(problem.gaussians[c], posterior) / channel.features.size
        result += [
            same.mean(),
            close.mean(),
            (same & close).mean(),
            np.arctan(x[0]),
            np.count_nonzero(posterior.counts),
        ]
        result += [np.arctan(emission), count_log_marginal(counts, prior.word_concentration), (counts**2).sum()]
        result += [mine[0], mine.mean(), np.mean(words[:, None] == words)]
        if isinstance(state, State):
            k = z[channel.speaker[0]]
            result += [np.exp(state.log_weights[c][k]), np.arctan(state.mean[c][k, -1])]
            result += [np.arctan(np.log(state.factor[c][k, 0, 0])), np.arctan(np.log(state.factor[c][k, -1, -1]))]
            result += [np.exp(state.log_words[c][k, words[0]]), np.sum(np.exp(2.0 * state.log_words[c][k]))]
    if problem.learns:
        result += np.log(problem.mean_precision).tolist()
    if problem.frame_prior.has_none:
        of_none = state.F == len(problem.priors)
        counts = none_counts(problem, of_none.astype(np.float64))
        result += [of_none.mean(), of_none[0], (counts**2).sum(), count_log_marginal(counts, 0.3)]
        if isinstance(state, State):
            result += [np.exp(state.log_words[-1][0, 0]), np.sum(np.exp(2.0 * state.log_words[-1]))]
    if problem.paths is not None:
        states = count_states(problem.paths, state.F, problem.trials.sentence_bounds)
        result += [(states**2).sum(), problem.paths.size @ states, states[1]]
        result += [(states[problem.paths.size > 1] ** 2).sum()]
    return np.array(result, dtype=np.float64)


def other_prior(prior: Prior, **factors: float) -> Prior:
    """The prior with some hyperparameters multiplied."""
    return prior.model_copy(update={name: getattr(prior, name) * factor for name, factor in factors.items()})


# Broken kernels: module, name of the function, and what makes a broken one of the right one.
Breaker = Callable[[Callable[..., Any]], Callable[..., Any]]


def _mishears(right: Callable[..., Any]) -> Callable[..., Any]:
    """Each category takes its neighbour's word distribution for its own."""

    def broken(problem: Problem, c: int, state: State) -> Floats:
        rolled = tuple(np.roll(log_words, 1, axis=0) for log_words in state.log_words)
        return np.asarray(right(problem, c, replace(state, log_words=rolled)))

    return broken


def _with_prior(**factors: float) -> Breaker:
    def other(argument: Any) -> Any:
        if isinstance(argument, Problem):
            return replace(argument, priors=tuple(other(prior) for prior in argument.priors))
        return other_prior(argument, **factors) if isinstance(argument, Prior) else argument

    return lambda right: lambda *arguments: right(*map(other, arguments))


def _without_counts(right: Callable[..., Any]) -> Callable[..., Any]:
    def broken(problem: Problem, c: int, z: Ints, F: Ints) -> Floats:
        prior = problem.priors[c]
        return np.full((prior.categories, len(problem.trials.vocabulary)), prior.word_concentration)

    return broken


def _frames_at_random(right: Callable[..., Any]) -> Callable[..., Any]:
    return lambda rng, problem, *rest: problem.frame_prior.draw(rng, problem.trials)


def _none_without_counts(right: Callable[..., Any]) -> Callable[..., Any]:
    return lambda problem, F: np.full((1, len(problem.trials.vocabulary)), problem.none_concentration)


def _order_forgotten(right: Callable[..., Any]) -> Callable[..., Any]:
    """Frames are drawn as if their order were not learned."""

    def broken(rng: np.random.Generator, problem: Problem, *rest: Any) -> Any:
        prior = problem.frame_prior
        assert isinstance(prior, Once)
        method = replace(problem.method, frame_prior=Once(prior.none))
        return right(rng, replace(problem, method=method), *rest)

    return broken


def _too_hot(right: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *arguments: right(*arguments[:-1], 2.0)


BROKEN: dict[str, dict[str, tuple[Any, str, Breaker]]] = {
    "blocked": {
        "z mishears": (conditionals, "assignment_log_weights", _mishears),
        "π with another α": (conditionals, "draw_weights", _with_prior(concentration=4.0)),
        "φ with another V0": (conditionals, "draw_categories", _with_prior(scale=1.5)),
        "φ with another κ0": (conditionals, "draw_categories", _with_prior(mean_precision=3.0)),
        "F is deaf": (conditionals, "draw_frames", _frames_at_random),
        "θ never learns": (words, "word_concentration", _without_counts),
        "θ of ∅ never learns": (words, "none_concentration", _none_without_counts),
        "order is forgotten": (conditionals, "draw_frames", _order_forgotten),
    },
    "collapsed": {
        "z with another α": (collapsed_assignments, "sweep_assignments", _with_prior(concentration=4.0)),
        "z with another V0": (collapsed_assignments, "sweep_assignments", _with_prior(scale=5.0)),
        "z with another γ": (collapsed_assignments, "sweep_assignments", _with_prior(word_concentration=0.02)),
        "z too hot": (collapsed_assignments, "sweep_assignments", _too_hot),
        "F is deaf": (collapsed_frames, "sweep_frames", _frames_at_random),
        "F too hot": (collapsed_frames, "sweep_frames", _too_hot),
        "order is forgotten": (collapsed_frames, "sweep_frames", _order_forgotten),
    },
}


def can_break(name: str, broken: str) -> bool:
    """Whether a method has what a broken kernel breaks."""
    prior = METHODS[name].frame_prior
    needed = {
        "F is deaf": prior.has_frames,
        "F too hot": prior.has_frames,
        "θ of ∅ never learns": prior.has_none,
        # Where words may be of no channel too few sentences of the tiny models name two for it to be seen.
        "order is forgotten": isinstance(prior, Once) and prior.ordered and not prior.none,
    }
    return needed.get(broken, True)
