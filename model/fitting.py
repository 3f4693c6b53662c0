"""Fit the model to trials: chains of a sampler, of which the best last state is kept."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from typing import Literal

import numpy as np

from model import blocked, collapsed
from model.compiled import compile_once
from model.data import Trials
from model.fits import Fit, History
from model.frames import METHODS, Rule
from model.joint import Priors, log_marginal_joint
from model.prior import Prior
from model.state import Partition, Settings, State

Inference = Literal["blocked", "collapsed"]
INFERENCE: tuple[Inference, ...] = ("blocked", "collapsed")
Progress = Callable[[int, int], None]


def fit(
    trials: Trials,
    method: str,
    rng: np.random.Generator,
    priors: Prior | Sequence[Prior] = Prior(),  # noqa: B008 (immutable)
    iterations: int = 200,
    chains: int = 1,
    settings: Settings = Settings(),  # noqa: B008 (immutable)
    progress: Progress | None = None,
    inference: Inference = "blocked",
    temperature: float = 1.0,
    keep_history: int = 0,
) -> Fit:
    """Fit by Gibbs sampling; of several chains the one whose last state is most probable is kept.

    Args:
        trials: the data, see `Trials.from_arrays`.
        method: `proposed`, `no_mec2`, `mmlda` or `gmm`.
        rng: all randomness; each chain gets a generator of its own spawned from it.
        priors: hyperparameters of all channels, or one for each.
        iterations: sweeps a chain.
        chains: number of chains. They are compared by log p(X, w, z, F), whichever the sampler.
        settings: deviations of the blocked sampler from the published algorithm.
        progress: called with the sweeps done and their total.
        inference: `blocked` (Algorithm 1 of the paper) or `collapsed`, which ends with posterior means of π, φ and θ.
        temperature: where annealing of the collapsed sampler starts; it falls linearly to 1 over the first half of
            the iterations. 1 is no annealing.
        keep_history: number of states whose z and F are kept, evenly spaced over the iterations up to the last.

    Raises:
        ValueError: an argument is out of its range, or a sentence is longer than the method can explain. All that
            is wrong with the arguments is named at once.

    Example:
        >>> rng = np.random.default_rng(0)
        >>> trials = Trials.from_arrays(
        ...     action=rng.normal(size=(3, 2)),
        ...     objects={"color": rng.normal(size=(4, 2))},
        ...     trial_of_object=[0, 1, 1, 2],
        ...     attended=[0, 1, 0],
        ...     sentences=[["grasp", "red"], ["blue"], []],
        ... )
        >>> result = fit(trials, "proposed", rng, iterations=5, inference="collapsed")
        >>> result.state.F.shape
        (3,)
        >>> [round(float(weights.sum()), 6) for weights in map(np.exp, result.state.log_weights)]
        [1.0, 1.0]
    """
    shared = (priors,) * len(trials.channels) if isinstance(priors, Prior) else tuple(priors)
    _check(trials, method, shared, iterations, chains, settings, inference, temperature, keep_history)
    compile_once(_warm_up)
    sampler = {
        "inference": inference,
        "iterations": iterations,
        "chains": chains,
        "temperature": temperature,
        **asdict(settings),
        **_seed(rng),
    }
    best: Fit | None = None
    for chain, chain_rng in enumerate(rng.spawn(chains)):
        states = _states(
            chain_rng, trials, METHODS[method].rule, shared, iterations, settings, inference, temperature
        )
        report = None if progress is None else _shifted(progress, chain * iterations, chains * iterations)
        candidate = _run_chain(states, trials, method, shared, iterations, sampler, keep_history, report)
        if best is None or candidate.trace_log_joint[-1] > best.trace_log_joint[-1]:
            best = candidate
    assert best is not None
    return best


def prepare() -> None:
    """Compile what fits need, if this machine has not done so yet: set-up calls it, so that no fit has to."""
    compile_once(_warm_up)


def load_compiled() -> None:
    """Load everything that is compiled into this process, and compile it before if need be."""
    prepare()
    _warm_up()


def annealed(temperature: float, iteration: int, iterations: int) -> float:
    """The temperature of an iteration 0, 1, …: from `temperature` linearly to 1 over the first half."""
    half = iterations // 2
    return 1.0 if iteration >= half else 1.0 + (temperature - 1.0) * (1.0 - iteration / half)


def _states(
    rng: np.random.Generator,
    trials: Trials,
    rule: Rule,
    priors: Priors,
    iterations: int,
    settings: Settings,
    inference: Inference,
    temperature: float,
) -> Iterator[State | Partition]:
    """The states of one chain after each iteration; a collapsed one ends as a whole `State`."""
    if inference == "blocked":
        state = blocked.init(rng, trials, rule, priors, settings)
        for _ in range(iterations):
            state = blocked.step(rng, state, trials, rule, priors, settings)
            yield state
        return
    partition = collapsed.init(rng, trials, rule, priors)
    for i in range(iterations):
        now = annealed(temperature, i, iterations)
        partition = collapsed.step(rng, partition, trials, rule, priors, now)
        yield partition if i < iterations - 1 else collapsed.posterior_means(trials, rule, priors, partition)


def _run_chain(
    states: Iterator[State | Partition],
    trials: Trials,
    method: str,
    priors: tuple[Prior, ...],
    iterations: int,
    sampler: dict[str, object],
    keep_history: int,
    progress: Callable[[int], None] | None,
) -> Fit:
    """Go through the states of a chain, trace it, and keep the last one."""
    log_joint = np.empty(iterations)
    used = np.empty((iterations, len(priors)), dtype=np.int64)
    kept = (np.arange(1, keep_history + 1) * iterations) // max(keep_history, 1) - 1
    history: list[Partition] = []
    for i, state in enumerate(states):
        log_joint[i] = log_marginal_joint(trials, METHODS[method].rule, priors, state.z, state.F)
        used[i] = [np.count_nonzero(np.bincount(z)) for z in state.z]
        if i in kept:
            history.append(Partition(state.z, state.F))
        if progress is not None:
            progress(i + 1)
    assert isinstance(state, State)
    past = History.of(kept + 1, history) if history else None
    return Fit(trials, method, priors, state, log_joint, used, sampler, past)


def _shifted(progress: Progress, done: int, total: int) -> Callable[[int], None]:
    return lambda step: progress(done + step, total)


def _seed(rng: np.random.Generator) -> dict[str, object]:
    """The seed of a generator in words, so that a fit tells where its draws come from."""
    sequence = rng.bit_generator.seed_seq
    if not isinstance(sequence, np.random.SeedSequence):
        return {"seed": None}
    seed = {
        "entropy": json.loads(json.dumps(sequence.entropy, default=str)),
        "spawn_key": list(sequence.spawn_key),
        "children_before": sequence.n_children_spawned,
    }
    return {"seed": seed}


def _check(
    trials: Trials,
    method: str,
    priors: tuple[Prior, ...],
    iterations: int,
    chains: int,
    settings: Settings,
    inference: str,
    temperature: float,
    keep_history: int,
) -> None:
    """Raise one ValueError for everything that is wrong with the arguments of `fit`."""
    wrong = []
    if method not in METHODS:
        wrong.append(f"method {method!r} is unknown (there are {', '.join(METHODS)})")
    if inference not in INFERENCE:
        wrong.append(f"inference {inference!r} is unknown (there are {', '.join(INFERENCE)})")
    if len(priors) != len(trials.channels):
        wrong.append(f"{len(priors)} priors for {len(trials.channels)} channels")
    if iterations < 1 or chains < 1:
        wrong.append(f"iterations = {iterations}, chains = {chains} (each must be at least 1)")
    if not 1.0 <= temperature < np.inf:
        wrong.append(f"temperature = {temperature} (must be at least 1)")
    if not 0 <= keep_history <= iterations:
        wrong.append(f"keep_history = {keep_history} (must be 0 to the number of iterations, {iterations})")
    if inference == "blocked" and temperature != 1.0:
        wrong.append("temperature applies to inference collapsed only")
    if inference == "collapsed" and settings != Settings():
        wrong.append("settings apply to inference blocked only")
    if wrong:
        raise ValueError("; ".join(wrong))


def _warm_up() -> None:
    """A tiny fit by each method and sampler, which calls every compiled function that a fit can need."""
    rng = np.random.default_rng(0)
    features, sentences = rng.random((6, 2)), [["a", "b"], ["b"], [], ["a"], ["a"], ["b"]]
    trials = Trials.from_arrays(features, {"object": features}, range(6), [0] * 6, sentences)
    for method in METHODS.values():
        for inference in INFERENCE:
            for _ in _states(rng, trials, method.rule, (Prior(categories=3),) * 2, 3, Settings(), inference, 1.0):
                pass
    log_marginal_joint(trials, "every", (Prior(),) * 2, (np.zeros(6, np.int64),) * 2, np.empty(0, np.int64))
