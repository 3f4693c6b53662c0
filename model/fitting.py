"""Fit the model to trials: chains of the sampler, of which the best last state is kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from model import blocked
from model.data import Floats, Ints, Prior, Trials
from model.frames import METHODS
from model.joint import log_marginal_joint
from model.state import Settings, State


@dataclass(frozen=True)
class Fit:
    """The last state of the best chain, and how it came about.

    Attributes:
        trials: what was fitted.
        method: name of the method in `METHODS`.
        priors: hyperparameters, one a channel.
        state: the last state.
        trace_log_joint: (iterations,) log p(X, w, z, F) with parameters integrated out, after each iteration.
        trace_used: (iterations, C) number of categories in use, after each iteration.
    """

    trials: Trials
    method: str
    priors: tuple[Prior, ...]
    state: State
    trace_log_joint: Floats
    trace_used: Ints


def fit(
    trials: Trials,
    method: str,
    rng: np.random.Generator,
    priors: Prior | Sequence[Prior] = Prior(),  # noqa: B008 (immutable)
    iterations: int = 200,
    chains: int = 1,
    settings: Settings = Settings(),  # noqa: B008 (immutable)
    progress: Callable[[int, int], None] | None = None,
) -> Fit:
    """Fit by blocked Gibbs sampling; of several chains the one whose last state is most probable is kept.

    Args:
        trials: the data, see `Trials.from_arrays`.
        method: `proposed`, `no_mec2`, `mmlda` or `gmm`.
        rng: all randomness; each chain gets a generator of its own spawned from it.
        priors: hyperparameters of all channels, or one for each.
        iterations: sweeps a chain.
        chains: number of chains.
        settings: deviations from the published algorithm.
        progress: called with the sweeps done and their total.

    Raises:
        ValueError: unknown method, no iteration or chain, or a sentence that the method cannot explain.

    Example:
        >>> rng = np.random.default_rng(0)
        >>> trials = Trials.from_arrays(
        ...     action=rng.normal(size=(3, 2)),
        ...     objects={"color": rng.normal(size=(4, 2))},
        ...     trial_of_object=[0, 1, 1, 2],
        ...     attended=[0, 1, 0],
        ...     sentences=[["grasp", "red"], ["blue"], []],
        ... )
        >>> result = fit(trials, "proposed", rng, iterations=5)
        >>> result.state.F.shape
        (3,)
    """
    if method not in METHODS:
        raise ValueError(f"method {method!r} is unknown (there are {', '.join(METHODS)})")
    if iterations < 1 or chains < 1:
        raise ValueError(f"iterations = {iterations}, chains = {chains} (each must be at least 1)")
    shared = (priors,) * len(trials.channels) if isinstance(priors, Prior) else tuple(priors)
    candidates = []
    for chain, chain_rng in enumerate(rng.spawn(chains)):
        report = None if progress is None else _shifted(progress, chain * iterations, chains * iterations)
        candidates.append(_run_chain(chain_rng, trials, method, shared, iterations, settings, report))
    return max(candidates, key=lambda candidate: float(candidate.trace_log_joint[-1]))


def _shifted(progress: Callable[[int, int], None], done: int, total: int) -> Callable[[int], None]:
    return lambda step: progress(done + step, total)


def _run_chain(
    rng: np.random.Generator,
    trials: Trials,
    method: str,
    priors: tuple[Prior, ...],
    iterations: int,
    settings: Settings,
    progress: Callable[[int], None] | None,
) -> Fit:
    rule = METHODS[method].rule
    state = blocked.init(rng, trials, rule, priors, settings)
    log_joint = np.empty(iterations)
    used = np.empty((iterations, len(priors)), dtype=np.int64)
    for i in range(iterations):
        state = blocked.step(rng, state, trials, rule, priors, settings)
        log_joint[i] = log_marginal_joint(trials, rule, priors, state.z, state.F)
        used[i] = [len(np.unique(z)) for z in state.z]
        if progress is not None:
            progress(i + 1)
    return Fit(trials, method, priors, state, log_joint, used)
