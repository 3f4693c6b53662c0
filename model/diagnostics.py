"""Diagnostics over the chains of a condition: whether they agree, and how many independent draws they are worth.

Labels of categories mean nothing from one chain to the next, so that only label-free quantities are compared. Chains
are fits of the same data by the same method, sampler and priors with different seeds.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from model.data import Floats
from model.fits import Fit


@dataclass(frozen=True)
class Diagnosis:
    """How well chains have mixed in one quantity.

    Attributes:
        quantity: Its name.
        mean: Over all chains and draws.
        sd: Standard deviation over all chains and draws.
        r_hat: Rank-normalised split R-hat (Vehtari et al. 2021); about 1 where chains agree, infinite where each
            stays at a value of its own. None where the quantity is the same everywhere, or the chain the only one,
            for then nothing can be said.
        ess_bulk: Effective sample size in the bulk; None where the quantity is the same everywhere, or where ArviZ
            finds none.
        ess_tail: Effective sample size in the tails, likewise.
    """

    quantity: str
    mean: float
    sd: float
    r_hat: float | None
    ess_bulk: float | None
    ess_tail: float | None


def chain_quantities(fits: Sequence[Fit], burn_in: float = 0.5, pairs: int = 20) -> dict[str, Floats]:
    """The label-free quantities along the chains, each (chains, draws).

    `log_joint` and `used_{x}` come from the traces. If the fits keep their history, `same_{x}_{i}_{j}` tells whether
    elements i and j of channel x share a category, for a fixed sample of pairs per channel, and `frame_{x}`
    which share of the words channel x explains.

    Args:
        fits: One a chain.
        burn_in: Share of the iterations left out at the start, 0 to below 1.
        pairs: Pairs a channel; the same ones for the same data.

    Raises:
        ValueError: No fits, or fits that are not chains of one posterior.
    """
    _check(fits, burn_in)
    first = fits[0]
    skipped = int(burn_in * len(first.trace_log_joint))
    result = {"log_joint": np.stack([fit.trace_log_joint[skipped:] for fit in fits])}
    for c, channel in enumerate(first.trials.channels):
        result[f"used_{channel.name}"] = np.stack([fit.trace_used[skipped:, c] for fit in fits]).astype(np.float64)
    histories = [fit.history for fit in fits if fit.history is not None]
    if len(histories) < len(fits):
        return result
    kept = histories[0].iterations > skipped
    for c, channel in enumerate(first.trials.channels):
        # A generator of its own: the pairs depend on the number of elements only.
        sample = np.random.default_rng(len(channel.features)).integers(len(channel.features), size=(pairs, 2))
        for i, j in np.unique(np.sort(sample, axis=1), axis=0):
            if i != j:
                z = [history.z[c][kept] for history in histories]
                result[f"same_{channel.name}_{i}_{j}"] = np.stack([part[:, i] == part[:, j] for part in z]).astype(
                    float
                )
        if histories[0].F.shape[1]:
            shares = [(history.F[kept] == c).mean(axis=1) for history in histories]
            result[f"frame_{channel.name}"] = np.stack(shares)
    return result


def diagnose(quantities: Mapping[str, Floats]) -> list[Diagnosis]:
    """R-hat and effective sample sizes of quantities (chains, draws), by ArviZ."""
    return [_diagnose_one(name, draws) for name, draws in quantities.items()]


def _diagnose_one(name: str, draws: Floats) -> Diagnosis:
    mean, sd = float(draws.mean()), float(draws.std())
    smallest = 1e-12 * float(np.abs(draws).max())
    if np.ptp(draws) <= smallest or draws.shape[1] < 4:
        return Diagnosis(name, mean, sd, None, None, None)
    arviz = _arviz()
    with np.errstate(divide="ignore", invalid="ignore"):
        r_hat = float(arviz.rhat(draws)) if len(draws) > 1 else np.nan
        bulk, tail = (float(arviz.ess(draws, method=part)) for part in ("bulk", "tail"))
    if np.all(np.ptp(draws, axis=1) <= smallest):
        r_hat = np.inf
    return Diagnosis(name, mean, sd, *(None if np.isnan(value) else value for value in (r_hat, bulk, tail)))


def rank_counts(draws: Floats, bins: int = 20) -> NDArray[np.int64]:
    """(chains, bins) how the ranks of each chain's draws among all draws spread: the data of a rank plot.

    Chains that agree have about the same count in each bin. Ties get their mean rank.

    Args:
        draws: (chains, draws) of one quantity.
        bins: Bins of equal width.
    """
    flat = draws.ravel()
    _, which, counts = np.unique(flat, return_inverse=True, return_counts=True)
    last = np.cumsum(counts)
    ranks = (last - (counts + 1) / 2.0)[which].reshape(draws.shape)
    index = np.minimum((ranks * bins / flat.size).astype(np.int64), bins - 1)
    return np.stack([np.bincount(row, minlength=bins) for row in index])


def _check(fits: Sequence[Fit], burn_in: float) -> None:
    """Raise ValueError unless the fits are chains of one posterior."""
    if not fits:
        raise ValueError("diagnostics need at least one fit")
    if not 0 <= burn_in < 1:
        raise ValueError(f"burn_in = {burn_in} (must be 0 to below 1)")
    first = fits[0]
    for number, fit in enumerate(fits[1:], start=2):
        differences = [
            what
            for what, same in (
                ("method", fit.problem.method == first.problem.method),
                ("priors", fit.problem.priors == first.problem.priors),
                ("sampler", fit.sampler == first.sampler),
                ("number of iterations", len(fit.trace_log_joint) == len(first.trace_log_joint)),
                ("words", np.array_equal(fit.trials.words, first.trials.words)),
                ("words", np.array_equal(fit.trials.word_trial, first.trials.word_trial)),
                ("features", _same_features(fit, first)),
                ("kept iterations", _kept_iterations(fit) == _kept_iterations(first)),
            )
            if not same
        ]
        if differences:
            raise ValueError(
                f"fit {number} is no other chain of the posterior of fit 1, for it has other "
                + ", ".join(dict.fromkeys(differences))
                + " (seeds of a condition share their words only where none are omitted)"
            )


def _same_features(one: Fit, other: Fit) -> bool:
    channels = zip(one.trials.channels, other.trials.channels, strict=False)
    return len(one.trials.channels) == len(other.trials.channels) and all(
        np.array_equal(a.features, b.features) and np.array_equal(a.speaker, b.speaker) for a, b in channels
    )


def _kept_iterations(fit: Fit) -> list[int]:
    return [] if fit.history is None else [int(i) for i in fit.history.iterations]


def _arviz() -> Any:
    """ArviZ, imported where it is used, for it takes seconds."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # It announces its next version at every import.
        import arviz
    return arviz
