"""The blocked Gibbs sampler, Algorithm 1 of the paper."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from model.samplers.base import Sampler
from model.state import State

if TYPE_CHECKING:
    from model.problem import Problem


class Blocked(Sampler[State]):
    """Algorithm 1 of the paper, and how the authors' program deviates from it (docs/model.md, The samplers)."""

    only_models = False
    kind: Literal["blocked"] = "blocked"
    averaged_draws: int = Field(
        default=1,
        ge=1,
        le=10_000,
        description="θ and μ are means of this many draws: 1 is the published algorithm, 100 the authors' program; "
        "above 1 the kernel does not leave the posterior invariant",
    )
    empty_category: Literal["prior", "uniform"] = Field(
        default="prior",
        description="where the mean of an empty category comes from: its prior, or uniformly the channel's box",
    )
    start_scale: float = Field(default=0.05, gt=0, description="Σ = start_scale · I at the start")

    @property
    def stream(self) -> str:
        """The name from which draws derive; averaged draws have their own."""
        return self.kind if self.averaged_draws == 1 else f"{self.kind}_averaged{self.averaged_draws}"

    def init(self, rng: np.random.Generator, problem: Problem) -> State:
        """Return a state with F at random, μ at k-means centres, Σ a multiple of I, π and θ from their priors."""
        from model.distributions.dirichlet import draw_log_dirichlet
        from model.kernels.start import k_means, stick_breaking

        W = len(problem.trials.vocabulary)
        z, log_weights, mean, factor, log_words = [], [], [], [], []
        for channel, prior in zip(problem.trials.channels, problem.priors, strict=True):
            K = prior.categories
            centres, nearest = k_means(rng, channel.features, K)
            z.append(nearest)
            log_weights.append(stick_breaking(rng, prior.concentration, K))
            mean.append(centres)
            factor.append(np.tile(np.sqrt(self.start_scale) * np.eye(channel.dim), (K, 1, 1)))
            log_words.append(draw_log_dirichlet(rng, np.full((K, W), prior.word_concentration), 1))
        if problem.frame_prior.has_none:
            log_words.append(draw_log_dirichlet(rng, np.full((1, W), problem.none_concentration), 1))
        F = problem.frame_prior.draw(rng, problem.trials)
        return State(tuple(z), F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))

    def step(self, rng: np.random.Generator, problem: Problem, state: State, iteration: int) -> State:
        """Update z, π and φ of each channel, then F, then θ (Algorithm 1 of the paper).

        Given z, F and θ the channels are independent, so that it makes no difference that the three
        updates of one channel are done before the next channel's.
        """
        from model.distributions.dirichlet import draw_categorical, draw_log_dirichlet
        from model.kernels import conditionals as given
        from model.kernels import words

        z, log_weights, mean, factor = [], [], [], []
        for c, prior in enumerate(problem.priors):
            z.append(draw_categorical(rng, given.assignment_log_weights(problem, c, state)))
            log_weights.append(given.draw_weights(rng, prior, z[c]))
            drawn = given.draw_categories(rng, problem, c, z[c], self.averaged_draws, self.empty_category)
            mean.append(drawn[0])
            factor.append(drawn[1])
        F = state.F
        if problem.frame_prior.has_frames:
            F = given.draw_frames(rng, problem, words.word_log_weights(problem, tuple(z), state.log_words), F)
        log_words = []
        for c in range(len(z)):
            concentration = words.word_concentration(problem, c, z[c], F)
            log_words.append(draw_log_dirichlet(rng, concentration, self.averaged_draws))
        if problem.frame_prior.has_none:
            log_words.append(draw_log_dirichlet(rng, words.none_concentration(problem, F), self.averaged_draws))
        return State(tuple(z), F, tuple(log_weights), tuple(mean), tuple(factor), tuple(log_words))

    def learn(self, rng: np.random.Generator, problem: Problem, state: State, iteration: int) -> Problem:
        """Return the problem with κ0 drawn for the channels that learn it, given μ and Σ."""
        from model.kernels.mean_precision import draw_given_gaussians

        return draw_given_gaussians(rng, problem, state)

    def finish(self, problem: Problem, state: State) -> State:
        """Return the state as it is, with λ where orders are learned: no step draws it."""
        from model.kernels.means import mean_orders

        return replace(state, log_orders=mean_orders(problem, state.F))
