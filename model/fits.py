"""A fit, and fits on disk: one npz file without pickled objects, one array per symbol of the model.

| array | symbol | shape |
| --- | --- | --- |
| `method`, `channels`, `vocabulary` | names | (), (C,), (W,) |
| `words`, `word_trial` | w and its trial d | (C, T), (T,) |
| `F` | F, index of a channel for each word, C for none (∅); empty without frames | (T,) or (0,) |
| `trace_log_joint` | log p(X, w, z, F) after each iteration | (iterations,) |
| `trace_used` | categories in use after each iteration | (iterations, C) |
| `trace_mean_precision` | only if learned: κ0 of each iteration | (iterations, C) |
| `features_{x}`, `speaker_{x}` | features of the elements, speaking element per trial | (N_x, dim_x), (D,) |
| `z_{x}` | z^x | (N_x,) |
| `pi_{x}`, `mu_{x}`, `Sigma_{x}` | π^x, μ^x, Σ^x | (K_x,), (K_x, dim_x), (K_x, dim_x, dim_x) |
| `theta_{x}` | θ^x | (K_x, W) |
| `theta_none` | only where words may be of no channel: θ^∅ | (1, W) |
| `lambda`, `orders` | only where it is learned: λ, and the channels in order, −1 behind the last | (S,), (S, C) |
| `prior_{x}` | hyperparameters of the channel as JSON | () |
| `sampler` | the settings of the sampler, and the generator's seed, as JSON | () |
| `history_iteration`, `history_F` | only if kept: number of the iteration from 1, F | (H,), (H, T) |
| `history_z_{x}` | only if kept: z^x | (H, N_x) |
| `marginal_F` | share of the states kept after burn-in in which each channel, or ∅, explains a word | (T, sources) |
| `summary_z_{x}` | the partition with the least expected variation of information over them | (N_x,) |
| `together_{x}` | share of them in which two elements share a category; only if N_x ≤ 1,000 | (N_x, N_x) |
| `chains_log_joint` | only of several chains: `trace_log_joint` of each | (chains, iterations) |
| `chains_used` | likewise `trace_used` | (chains, iterations, C) |
| `chains_marginal_F` | likewise `marginal_F` | (chains, T, sources) |

Without kept states there is no history and no summary, without frames no `marginal_F`.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.files import write_arrays
from model.data import Channel, Floats, Ints, Trials
from model.frame_paths import order_table
from model.history import Chains, History, burned
from model.knowledge import Knowledge, of_history, of_last, of_summary
from model.methods import METHODS
from model.prior import Prior
from model.problem import Problem
from model.samplers import Sampler, sampler_of
from model.state import State
from model.summaries import Summary


@dataclass(frozen=True)
class Fit:
    """The last state of the best chain, and how it came about.

    Attributes:
        problem: What was fitted, by which method and with which hyperparameters, a learned κ0 as in the last
            state.
        sampler: The sampler and its settings.
        state: The last state.
        trace_log_joint: (iterations,) log p(X, w, z, F) with parameters integrated out, after each iteration.
        trace_used: (iterations, C) number of categories in use, after each iteration.
        trace_mean_precision: (iterations, C) κ0 of each channel where any learns it, else None.
        seed: Entropy and key of the generator's SeedSequence, if it has one.
        history: The states that were asked for, if any.
        summary: What those after burn-in have in common; None if none were kept.
        chains: What all chains went through, if there were several.
    """

    problem: Problem
    sampler: Sampler[Any]
    state: State
    trace_log_joint: Floats
    trace_used: Ints
    trace_mean_precision: Floats | None = None
    seed: Mapping[str, Any] | None = None
    history: History | None = None
    summary: Summary | None = None
    chains: Chains | None = None

    def __repr__(self) -> str:
        """What was fitted, how, and how it ended, on one line rather than in thousands of numbers."""
        channels = self.trials.channels
        used = ", ".join(
            f"{channel.name} {count}" for channel, count in zip(channels, self.trace_used[-1], strict=True)
        )
        return (
            f"<Fit of {self.problem.method.name} by {self.sampler.kind}: {len(channels[0].speaker)} trials, "
            f"{self.trials.words.shape[1]} words, {len(self.trace_log_joint)} iterations, "
            f"log joint {self.trace_log_joint[-1]:.2f}, categories: {used}>"
        )

    @property
    def trials(self) -> Trials:
        """What was fitted."""
        return self.problem.trials

    @cached_property
    def kept(self) -> History | None:
        """The kept states after burn-in; None if there are none."""
        if self.history is None:
            return None
        return self.history.after(burned(self.sampler.burn_in, len(self.trace_log_joint)))

    @cached_property
    def knowledge(self) -> Knowledge:
        """The parameters that the tasks use, as the sampler's setting `parameters` says.

        Raises:
            ValueError: They are those of kept states, and there are none.
        """
        if self.sampler.parameters == "draw":
            return of_last(self.state)
        if self.summary is None or self.kept is None:
            raise ValueError(f"parameters: {self.sampler.parameters} needs kept states, but the fit has none")
        if self.sampler.parameters == "mean":
            return of_summary(self.problem, self.summary, self.kept)
        return of_history(self.problem, self.summary, self.kept)


def save(fit: Fit, path: Path) -> None:
    """Write a fit: to a temporary name first, so that no half-written file carries the name.

    The same fit always gives the same bytes.
    """
    trials, state = fit.problem.trials, fit.state
    history, chains, summary = fit.history, fit.chains, fit.summary
    arrays: dict[str, Any] = {
        "method": np.array(fit.problem.method.name),
        "channels": np.array([channel.name for channel in trials.channels]),
        "vocabulary": np.array(trials.vocabulary, dtype=np.str_),
        "words": trials.words,
        "word_trial": trials.word_trial,
        "F": state.F,
        "trace_log_joint": fit.trace_log_joint,
        "trace_used": fit.trace_used,
        "sampler": np.array(json.dumps(fit.sampler.model_dump() | {"seed": fit.seed}, sort_keys=True)),
        "trace_mean_precision": fit.trace_mean_precision,
        "history_iteration": history and history.iterations,
        "history_F": history and history.F,
        "chains_log_joint": chains and chains.log_joint,
        "chains_used": chains and chains.used,
        "chains_marginal_F": chains and chains.marginals,
        "marginal_F": summary and summary.marginals,
        "theta_none": np.exp(state.log_words[-1]) if fit.problem.frame_prior.has_none else None,
        "lambda": np.exp(state.log_orders) if len(state.log_orders) else None,
        "orders": order_table(len(trials.channels)) if len(state.log_orders) else None,
    }
    for c, channel in enumerate(trials.channels):
        arrays |= {
            f"features_{channel.name}": channel.features,
            f"speaker_{channel.name}": channel.speaker,
            f"z_{channel.name}": state.z[c],
            f"pi_{channel.name}": np.exp(state.log_weights[c]),
            f"mu_{channel.name}": state.mean[c],
            # Not by a library's matrix product, whose last digits depend on its version and threads.
            f"Sigma_{channel.name}": np.einsum("kij,klj->kil", state.factor[c], state.factor[c]),
            f"theta_{channel.name}": np.exp(state.log_words[c]),
            f"prior_{channel.name}": np.array(json.dumps(fit.problem.priors[c].model_dump(), sort_keys=True)),
            f"history_z_{channel.name}": history and history.z[c],
            f"summary_z_{channel.name}": summary and summary.z[c],
            f"together_{channel.name}": summary and summary.together[c],
        }
    write_arrays(path, {name: array for name, array in arrays.items() if array is not None})


def load(path: Path) -> Fit:
    """Read a fit.

    Raises:
        ValueError: The file is not a fit, or is damaged; the message names it.
    """
    try:
        with np.load(path, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        if not all(isinstance(array, np.ndarray) for array in arrays.values()):
            raise ValueError("a part is no array")  # NumPy gives its bytes
        return _from_arrays(arrays)
    except OSError:
        raise
    except Exception as error:  # damaged bytes surface as zip, zlib, memory, key, … errors
        raise ValueError(f"{path} is not a readable fit: {error}") from error


def _cholesky(covariance: Floats) -> Floats:
    """(K, dim, dim) lower Cholesky factors; rounding of a nearly singular covariance is no error."""
    from model.distributions.triangular import factorise

    upper = np.triu(covariance)
    for matrix in upper:
        factorise(matrix, float(np.finfo(np.float64).tiny))
    return np.ascontiguousarray(upper.transpose(0, 2, 1))


def _log(probability: Floats) -> Floats:
    """Logarithms; a probability that underflowed to 0 counts as the smallest number: nothing is impossible."""
    return np.asarray(np.log(np.maximum(probability, np.nextafter(0.0, 1.0))))


def _from_arrays(arrays: dict[str, Any]) -> Fit:
    names = [str(name) for name in arrays["channels"]]
    channels = tuple(Channel(name, arrays[f"features_{name}"], arrays[f"speaker_{name}"]) for name in names)
    vocabulary = tuple(str(word) for word in arrays["vocabulary"])
    priors = tuple(Prior.model_validate_json(str(arrays[f"prior_{name}"])) for name in names)
    settings = json.loads(str(arrays["sampler"]))
    seed = settings.pop("seed")
    state = State(
        z=tuple(arrays[f"z_{name}"] for name in names),
        log_weights=tuple(_log(arrays[f"pi_{name}"]) for name in names),
        mean=tuple(arrays[f"mu_{name}"] for name in names),
        factor=tuple(_cholesky(arrays[f"Sigma_{name}"]) for name in names),
        log_words=tuple(_log(arrays[f"theta_{name}"]) for name in (*names, "none") if f"theta_{name}" in arrays),
        log_orders=_log(arrays.get("lambda", np.empty(0))),
        F=arrays["F"],
    )
    history, summary, chains, kappa = None, None, None, arrays.get("trace_mean_precision")
    if "history_iteration" in arrays:
        z = tuple(arrays[f"history_z_{name}"] for name in names)
        after = arrays["history_iteration"]
        history = History(after, z, arrays["history_F"], None if kappa is None else kappa[after - 1])
    if f"summary_z_{names[0]}" in arrays:
        z = tuple(arrays[f"summary_z_{name}"] for name in names)
        together = tuple(arrays.get(f"together_{name}") for name in names)
        summary = Summary(z, together, arrays.get("marginal_F"))
    if "chains_log_joint" in arrays:
        chains = Chains(arrays["chains_log_joint"], arrays["chains_used"], arrays.get("chains_marginal_F"))
    trials = Trials(channels, arrays["words"], arrays["word_trial"], vocabulary)
    problem = Problem(trials, METHODS[str(arrays["method"])], priors)
    return Fit(
        problem=problem if kappa is None else problem.given(kappa[-1]),
        sampler=sampler_of(settings),
        state=state,
        trace_log_joint=arrays["trace_log_joint"],
        trace_used=arrays["trace_used"],
        trace_mean_precision=kappa,
        seed=seed,
        history=history,
        summary=summary,
        chains=chains,
    )
