"""Fit the model to trials: chains of a sampler, of which the best last state is kept."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from model.data import Trials
from model.fits import Fit, History
from model.methods import METHODS
from model.prior import Prior
from model.problem import Problem
from model.samplers import SAMPLERS, Sampler
from model.state import Partition

Progress = Callable[[int, int], None]


def fit(problem: Problem, sampler: Sampler[Any], rng: np.random.Generator, progress: Progress | None = None) -> Fit:
    """Fit by Gibbs sampling; of several chains the one whose last state is most probable is kept.

    Args:
        problem: The data, the method and the hyperparameters, see `Problem.of`.
        sampler: One of `model.samplers`, with its settings.
        rng: All randomness; each chain gets a generator of its own spawned from it.
        progress: Called with the sweeps done and their total.

    Example:
        >>> rng = np.random.default_rng(0)
        >>> trials = Trials.from_arrays(
        ...     action=rng.normal(size=(3, 2)),
        ...     objects={"color": rng.normal(size=(4, 2))},
        ...     trial_of_object=[0, 1, 1, 2],
        ...     attended=[0, 1, 0],
        ...     sentences=[["grasp", "red"], ["blue"], []],
        ... )
        >>> result = fit(Problem.of(trials, "proposed"), SAMPLERS["collapsed"](iterations=5), rng)
        >>> result.state.F.shape
        (3,)
        >>> [round(float(weights.sum()), 6) for weights in map(np.exp, result.state.log_weights)]
        [1.0, 1.0]
    """
    prepare()
    seed, total, fits = _seed(rng), sampler.chains * sampler.iterations, []
    for chain, chain_rng in enumerate(rng.spawn(sampler.chains)):

        def report(sweeps: int, before: int = chain * sampler.iterations) -> None:
            if progress is not None:
                progress(before + sweeps, total)

        fits.append(_run_chain(problem, sampler, chain_rng, seed, report))
    return max(fits, key=lambda one: float(one.trace_log_joint[-1]))  # the first of equals


def prepare() -> None:
    """Compile what fits need, if this machine has not done so yet: set-up calls it, so that no fit has to."""
    from model.compiled import compile_once

    compile_once(_warm_up)


def load_compiled() -> None:
    """Load everything that is compiled into this process, and compile it before if need be."""
    prepare()
    _warm_up()


def _run_chain(
    problem: Problem,
    sampler: Sampler[Any],
    rng: np.random.Generator,
    seed: dict[str, Any] | None,
    progress: Callable[[int], None],
) -> Fit:
    """Run a chain, trace it, and keep its last state."""
    from model.joint import log_marginal_joint

    iterations, keep = sampler.iterations, min(sampler.keep_history, sampler.iterations)
    log_joint = np.empty(iterations)
    used = np.empty((iterations, len(problem.priors)), dtype=np.int64)
    kept = [(h * iterations) // keep for h in range(1, keep + 1)]
    history: list[Partition] = []
    state = sampler.init(rng, problem)
    for i in range(iterations):
        state = sampler.step(rng, problem, state, i)
        log_joint[i] = log_marginal_joint(problem, state)
        used[i] = [np.count_nonzero(np.bincount(z)) for z in state.z]
        if i + 1 in kept:
            history.append(state)
        progress(i + 1)
    past = History.of(np.array(kept), history) if history else None
    return Fit(problem, sampler, sampler.finish(problem, state), log_joint, used, seed, past)


def _seed(rng: np.random.Generator) -> dict[str, Any] | None:
    """The seed of a generator in words, so that a fit tells where its draws come from."""
    sequence = rng.bit_generator.seed_seq
    if not isinstance(sequence, np.random.SeedSequence):
        return None
    return {
        "entropy": json.loads(json.dumps(sequence.entropy, default=str)),
        "spawn_key": list(sequence.spawn_key),
        "children_before": sequence.n_children_spawned,
    }


def _warm_up() -> None:
    """A tiny fit by each method and sampler, which calls every compiled function that a fit can need."""
    rng = np.random.default_rng(0)
    features, sentences = rng.random((6, 2)), [["a", "b"], ["b"], [], ["a"], ["a"], ["b"]]
    trials = Trials.from_arrays(features, {"object": features}, range(6), [0] * 6, sentences)
    for method in METHODS:
        for kind in SAMPLERS.values():
            _run_chain(Problem.of(trials, method, Prior(categories=3)), kind(iterations=3), rng, None, lambda _: None)
