"""What the tasks take from a fit: π, φ and θ of one state, of the summary, or of many states."""

from __future__ import annotations

from dataclasses import dataclass, replace

from model.history import History
from model.problem import Problem
from model.state import Partition, State
from model.summaries import Summary, aligned

# Kept states over which scores are averaged, at most.
MOST_AVERAGED = 50


@dataclass(frozen=True)
class Knowledge:
    """Parameters, as tasks use them.

    Attributes:
        states: A score is the mean of the probabilities under each of them.
        categories: The state that numbers the categories for all of them, and that tells what they look like.
    """

    states: tuple[State, ...]
    categories: State


def of_last(state: State) -> Knowledge:
    """The parameters of a chain's last state."""
    return Knowledge((state,), state)


def of_summary(problem: Problem, summary: Summary, kept: History) -> Knowledge:
    """Posterior means at the summary: its partitions, and words that count for each channel as often as expected."""
    from model.kernels.means import mean_orders, posterior_means

    # The most probable channel of each word alone need be no frame: λ comes from the states' frames.
    given = Partition(summary.z, kept.F[0])
    means = posterior_means(kept.typical(problem), given, summary.marginals)
    return of_last(replace(means, F=summary.channels, log_orders=mean_orders(problem, kept.F)))


def of_history(problem: Problem, summary: Summary, kept: History) -> Knowledge:
    """Posterior means given each kept state, its categories named after those of the summary which they resemble.

    A state stays as probable under other names, and without them a category of one state would be averaged with
    another of the next.
    """
    from model.kernels.means import posterior_means

    pivot = [(z, prior.categories) for z, prior in zip(summary.z, problem.priors, strict=True)]
    states, chosen = [], kept.thinned(MOST_AVERAGED)
    for given, state in chosen.states(problem):
        z = tuple(aligned(own, reference, K) for own, (reference, K) in zip(state.z, pivot, strict=True))
        states.append(posterior_means(given, Partition(z, state.F)))
    return Knowledge(tuple(states), of_summary(problem, summary, kept).categories)
