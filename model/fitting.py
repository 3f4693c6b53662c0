"""Fit the model to trials: chains of a sampler, of which the best last state is kept."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from model.data import Floats, Ints, Trials
from model.fits import Fit
from model.history import Chains, History, burned, evenly
from model.methods import METHODS
from model.prior import Prior
from model.problem import Problem
from model.samplers import SAMPLERS, Sampler
from model.state import Partition, State
from model.summaries import summarise, word_marginals

Progress = Callable[[int, int], None]


def fit(problem: Problem, sampler: Sampler[Any], rng: np.random.Generator, progress: Progress | None = None) -> Fit:
    """Fit by Gibbs sampling; of several chains the one whose last state is most probable is kept.

    Args:
        problem: The data, the method and the hyperparameters, see `Problem.of`.
        sampler: One of `model.samplers`, with its settings.
        rng: All randomness; each chain gets a generator of its own spawned from it.
        progress: Called with the sweeps done and their total.

    Raises:
        ValueError: The sampler cannot fit the method.

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
    if not sampler.takes(problem.method):
        raise ValueError(f"{problem.method.name} is no generative model, which a {sampler.kind} sampler needs")
    prepare()
    seed, total, chains = _seed(rng), sampler.chains * sampler.iterations, []
    for chain, chain_rng in enumerate(rng.spawn(sampler.chains)):

        def report(sweeps: int, before: int = chain * sampler.iterations) -> None:
            if progress is not None:
                progress(before + sweeps, total)

        chains.append(_run_chain(problem, sampler, chain_rng, report))
    return _fit_of(problem, sampler, chains, seed)


def prepare() -> None:
    """Compile what fits need, if this machine has not done so yet: set-up calls it, so that no fit has to."""
    from model.compiled import compile_once

    compile_once(_warm_up)


def load_compiled() -> None:
    """Load everything that is compiled into this process, and compile it before if need be."""
    prepare()
    _warm_up()


@dataclass(frozen=True)
class _Chain:
    """A chain: its last κ0 and state, with π, φ and θ; traces as of a fit; kept states, and those after burn-in."""

    problem: Problem
    state: State
    log_joint: Floats
    used: Ints
    mean_precision: Floats | None
    history: History | None
    kept: History | None


def _run_chain(
    problem: Problem, sampler: Sampler[Any], rng: np.random.Generator, progress: Callable[[int], None]
) -> _Chain:
    """Run a chain, trace it, and keep its last state."""
    iterations = sampler.iterations
    log_joint = np.empty(iterations)
    used = np.empty((iterations, len(problem.priors)), dtype=np.int64)
    mean_precision = np.empty(used.shape) if problem.learns else None
    kept = [i + 1 for i in evenly(iterations, sampler.keep_history)]
    history: list[Partition] = []
    state = sampler.init(rng, problem)
    for i in range(iterations):
        if mean_precision is not None:
            problem = sampler.learn(rng, problem, state, i)
            mean_precision[i] = problem.mean_precision
        state = sampler.step(rng, problem, state, i)
        log_joint[i] = sampler.log_joint(problem, state)
        used[i] = [np.count_nonzero(np.bincount(z)) for z in state.z]
        if i + 1 in kept:
            history.append(Partition(state.z, state.F))
        progress(i + 1)
    past = History.of(np.array(kept), history, mean_precision) if history else None
    after = None if past is None else past.after(burned(sampler.burn_in, iterations))
    return _Chain(problem, sampler.finish(problem, state), log_joint, used, mean_precision, past, after)


def _fit_of(problem: Problem, sampler: Sampler[Any], chains: Sequence[_Chain], seed: dict[str, Any] | None) -> Fit:
    """The fit that keeps the best of the chains, and compares all if there are several."""
    best = max(chains, key=lambda one: float(one.log_joint[-1]))  # the first of equals
    return Fit(
        problem=best.problem,
        sampler=sampler,
        state=best.state,
        trace_log_joint=best.log_joint,
        trace_used=best.used,
        trace_mean_precision=best.mean_precision,
        seed=seed,
        history=best.history,
        summary=None if best.kept is None else summarise(problem, best.kept),
        chains=_compared(problem, chains) if len(chains) > 1 else None,
    )


def _compared(problem: Problem, chains: Sequence[_Chain]) -> Chains:
    """The traces of all chains, and what the kept states of each say of the words."""
    marginals = [word_marginals(problem, chain.kept) for chain in chains if chain.kept is not None]
    known = [one for one in marginals if one is not None]
    return Chains(
        log_joint=np.stack([chain.log_joint for chain in chains]),
        used=np.stack([chain.used for chain in chains]),
        marginals=np.stack(known) if known else None,
    )


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
        for kind in (own for own in SAMPLERS.values() if own().takes(METHODS[method])):
            problem, sampler = Problem.of(trials, method, Prior(categories=3)), kind(iterations=3, parameters="mean")
            chain = _run_chain(problem, sampler, rng, lambda _: None)
            _ = _fit_of(problem, sampler, [chain], None).knowledge
