"""Both samplers behind one face, and kernels that are broken on purpose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from model import Prior, Settings, State, Trials, blocked, collapsed
from model.kernels import conditionals as given
from model.data import Floats, Ints
from model.distributions.dirichlet import count_log_marginal
from model.frames import METHODS
from model.distributions.gaussian_densities import gaussian_log_marginal
from model.distributions.gaussians import gaussian_posterior
from model.joint import draw_data, draw_frames_prior, draw_parameters
from model.state import Partition
from tests.synthetic import trials_of_model

Priors = tuple[Prior, ...]
RULES = {name: method.rule for name, method in METHODS.items() if name != "gmm"}


@dataclass(frozen=True)
class Sampler:
    """A kernel with what tests need around it.

    Attributes:
        init: a state for data, far from the posterior perhaps.
        step: the kernel.
        of: the part of a whole state that this sampler moves.
        redraw: new data given a state.
    """

    init: Callable[..., Any]
    step: Callable[..., Any]
    of: Callable[[State], Any]
    redraw: Callable[..., Trials]


def _redraw_collapsed(
    rng: np.random.Generator, design: Trials, rule: Any, priors: Priors, state: Partition
) -> Trials:
    """Data given z and F: parameters from their prior, which z and F do not touch."""
    parameters = draw_parameters(rng, design, rule, priors)
    return draw_data(rng, design, rule, replace(parameters, z=state.z, F=state.F))


SAMPLERS = {
    "blocked": Sampler(
        init=lambda rng, trials, rule, priors: blocked.init(rng, trials, rule, priors, Settings()),
        step=lambda rng, state, trials, rule, priors: blocked.step(rng, state, trials, rule, priors, Settings()),
        of=lambda state: state,
        redraw=lambda rng, design, rule, priors, state: draw_data(rng, design, rule, state),
    ),
    "collapsed": Sampler(
        init=collapsed.init,
        step=collapsed.step,
        of=lambda state: Partition(state.z, state.F),
        redraw=_redraw_collapsed,
    ),
}


def tiny_trials(objects: list[int], lengths: list[int], W: int) -> Trials:
    """Trials with two channels: a two-dimensional action and a one-dimensional color."""
    trials = trials_of_model(np.random.default_rng(8), objects, lengths, W=W)
    vocabulary = tuple(f"word{i}" for i in range(W))
    words = np.tile(np.arange(sum(lengths)) % W, (2, 1))
    return replace(trials, channels=(trials.channels[0], trials.channels[2]), words=words, vocabulary=vocabulary)


def quantities(trials: Trials, rule: Any, priors: Priors, state: State | Partition) -> Floats:
    """Label-free numbers of data and state, bounded or with light tails, of which each block moves some."""
    result: list[Any] = []
    for c, (channel, prior) in enumerate(zip(trials.channels, priors, strict=True)):
        z, x, K = state.z[c], channel.features[:, 0], prior.categories
        pairs = np.triu_indices(len(z), 1)
        same, close = (z[:, None] == z)[pairs], (np.abs(x[:, None] - x) < 0.5)[pairs]
        mine = given.explained_words(rule, state.F, c, len(trials.word_trial))
        counts = given.word_counts(trials, c, prior, z, mine)
        law = gaussian_posterior(channel.features, z, K, *prior.gaussian(channel.dim))
        emission = gaussian_log_marginal(prior.gaussian(channel.dim), law) / channel.features.size
        words = trials.words[c]
        result += [same.mean(), close.mean(), (same & close).mean(), np.arctan(x[0]), np.count_nonzero(law.counts)]
        result += [np.arctan(emission), count_log_marginal(counts, prior.word_concentration), (counts**2).sum()]
        result += [mine[0], mine.mean(), np.mean(words[:, None] == words)]
        if isinstance(state, State):
            k = z[channel.speaker[0]]
            result += [np.exp(state.log_weights[c][k]), np.arctan(state.mean[c][k, -1])]
            result += [np.arctan(np.log(state.factor[c][k, 0, 0])), np.arctan(np.log(state.factor[c][k, -1, -1]))]
            result += [np.exp(state.log_words[c][k, words[0]]), np.sum(np.exp(2.0 * state.log_words[c][k]))]
    return np.array(result, dtype=np.float64)


def other_prior(prior: Prior, **factors: float) -> Prior:
    """The prior with some hyperparameters multiplied."""
    return replace(prior, **{name: getattr(prior, name) * factor for name, factor in factors.items()})


# Broken kernels: module, name of the function, and what makes a broken one of the right one.
Breaker = Callable[[Callable[..., Any]], Callable[..., Any]]


def _mishears(right: Callable[..., Any]) -> Callable[..., Any]:
    """Each category takes its neighbour's word distribution for its own."""
    return lambda trials, c, log_weights, mean, factor, log_words, explained: right(
        trials, c, log_weights, mean, factor, np.roll(log_words, 1, axis=0), explained
    )


def _with_prior(**factors: float) -> Breaker:
    def make(right: Callable[..., Any]) -> Callable[..., Any]:
        def broken(*arguments: Any) -> Any:
            return right(*(other_prior(a, **factors) if isinstance(a, Prior) else a for a in arguments))

        return broken

    return make


def _without_counts(right: Callable[..., Any]) -> Callable[..., Any]:
    def broken(trials: Trials, c: int, prior: Prior, z: Ints, explained: Any) -> Floats:
        return np.full((prior.categories, len(trials.vocabulary)), prior.word_concentration)

    return broken


def _frames_at_random(right: Callable[..., Any]) -> Callable[..., Any]:
    return lambda rng, trials, rule, *rest: draw_frames_prior(rng, trials, rule)


def _too_hot(right: Callable[..., Any]) -> Callable[..., Any]:
    return lambda *arguments: right(*arguments[:-1], 2.0)


BROKEN: dict[str, dict[str, tuple[Any, str, Breaker]]] = {
    "blocked": {
        "z mishears": (given, "assignment_log_weights", _mishears),
        "π with another α": (given, "draw_weights", _with_prior(concentration=4.0)),
        "φ with another V0": (given, "draw_categories", _with_prior(scale=1.5)),
        "φ with another κ0": (given, "draw_categories", _with_prior(mean_precision=3.0)),
        "F is deaf": (given, "draw_frames", _frames_at_random),
        "θ never learns": (given, "word_concentration", _without_counts),
    },
    "collapsed": {
        "z with another α": (collapsed, "draw_assignments", _with_prior(concentration=4.0)),
        "z with another V0": (collapsed, "draw_assignments", _with_prior(scale=5.0)),
        "z with another γ": (collapsed, "draw_assignments", _with_prior(word_concentration=0.02)),
        "z too hot": (collapsed, "draw_assignments", _too_hot),
        "F is deaf": (collapsed, "draw_frames", _frames_at_random),
        "F too hot": (collapsed, "draw_frames", _too_hot),
    },
}
# Without frames there is none to break.
ONLY_WITH_FRAMES = ("F is deaf", "F too hot")
