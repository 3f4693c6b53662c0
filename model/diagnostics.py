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

from model.data import Floats, Ints, Trials
from model.fits import Fit
from model.history import burned
from model.prior import LEARNED

# Shares of pairs of elements and of words are told by name of their channel behind these.
PAIR, FRAME, WORD = "same_", "frame_", "word_"
# What is told of a learned κ0.
MEAN_PRECISION = "mean_precision_"


@dataclass(frozen=True)
class Diagnosis:
    """How well chains have mixed in one quantity.

    Attributes:
        quantity: Its name.
        mean: Over all chains and draws.
        sd: Standard deviation over all chains and draws; 0 where the quantity is the same everywhere.
        r_hat: Rank-normalised split R-hat (Vehtari et al. 2021); about 1 where chains agree, infinite where each
            stays at a value of its own. None where the quantity is the same everywhere, the chain the only one, or
            shorter than four draws, for then nothing can be said.
        ess_bulk: Effective sample size in the bulk; None where the quantity is the same everywhere, or where ArviZ
            finds none.
        ess_tail: Effective sample size in the tails, likewise.
        chains: How many chains there are.
        draws: How many draws each has.
    """

    quantity: str
    mean: float
    sd: float
    r_hat: float | None
    ess_bulk: float | None
    ess_tail: float | None
    chains: int
    draws: int


def chain_quantities(fits: Sequence[Fit], burn_in: float | None = None, pairs: int = 20) -> dict[str, Floats]:
    """The label-free quantities along the chains, each (chains, draws).

    `log_joint`, `used_{x}` and, where κ0 is learned, `mean_precision_{x}`, log10 of it, come from the traces, which
    have every iteration. If the fits keep their history, its states tell the rest: `same_{x}_{i}_{j}` whether
    elements i and j of channel x share a category, for a fixed sample of pairs per channel; `frame_{x}` which share
    of the words channel x explains; `word_{x}_{w}` which share of the tokens of word w.

    Args:
        fits: One a chain.
        burn_in: Share of the iterations left out at the start, 0 to below 1; by default what the sampler says.
        pairs: Pairs a channel; the same ones for the same data.

    Raises:
        ValueError: No fits, or fits that are not chains of one posterior.
    """
    check_chains(fits)
    first, skipped = fits[0], skipped_iterations(fits[0], burn_in)
    result = {"log_joint": np.stack([fit.trace_log_joint[skipped:] for fit in fits])}
    for c, channel in enumerate(first.trials.channels):
        result[f"used_{channel.name}"] = np.stack([fit.trace_used[skipped:, c] for fit in fits]).astype(np.float64)
        learned = [fit.trace_mean_precision[skipped:, c] for fit in fits if fit.trace_mean_precision is not None]
        if learned and first.problem.priors[c].mean_precision == LEARNED:
            result[f"{MEAN_PRECISION}{channel.name}"] = np.log10(np.stack(learned))
    histories = [fit.history for fit in fits if fit.history is not None]
    if len(histories) < len(fits):
        return result
    kept = histories[0].iterations > skipped
    for c, channel in enumerate(first.trials.channels):
        z = np.stack([history.z[c][kept] for history in histories])
        result |= {
            f"{PAIR}{channel.name}_{i}_{j}": (z[:, :, i] == z[:, :, j]).astype(np.float64)
            for i, j in _pairs_of(len(channel.features), pairs)
        }
    if not first.problem.method.has_frames:
        return result
    return result | _word_shares(first.trials, np.stack([history.F[kept] for history in histories]))


def skipped_iterations(fit: Fit, burn_in: float | None) -> int:
    """How many iterations of a fit do not count, given their share; None for that of its sampler.

    Raises:
        ValueError: The share is not one from 0 to below 1.
    """
    share = fit.sampler.burn_in if burn_in is None else burn_in
    if not 0 <= share < 1:
        raise ValueError(f"burn_in = {burn_in} (must be 0 to below 1)")
    return burned(share, len(fit.trace_log_joint))


def _pairs_of(elements: int, pairs: int) -> list[tuple[int, int]]:
    """Pairs of different elements, drawn by a generator of their own: they depend on the number of elements only."""
    sample = np.random.default_rng(elements).integers(elements, size=(pairs, 2))
    return [(int(i), int(j)) for i, j in np.unique(np.sort(sample, axis=1), axis=0) if i != j]


def _word_shares(trials: Trials, F: Ints) -> dict[str, Floats]:
    """(chains, draws) of each channel the share of the tokens that it explains, of all words and of each word.

    Args:
        trials: What the chains explain.
        F: (chains, draws, T) the channel of each token; (chains, draws, 0) for a method without frames.
    """
    if not F.shape[2]:
        return {}
    heard = np.unique(trials.words[0])
    tokens = {trials.vocabulary[w]: np.flatnonzero(trials.words[0] == w) for w in heard}
    result = {}
    for c, channel in enumerate(trials.channels):
        explained = F == c
        result[f"{FRAME}{channel.name}"] = explained.mean(axis=2)
        result |= {
            f"{WORD}{channel.name}_{word}": explained[:, :, places].mean(axis=2) for word, places in tokens.items()
        }
    return result


def diagnose(quantities: Mapping[str, Floats]) -> list[Diagnosis]:
    """R-hat and effective sample sizes of quantities (chains, draws), by ArviZ."""
    return [_diagnose_one(name, draws) for name, draws in quantities.items()]


def _diagnose_one(name: str, draws: Floats) -> Diagnosis:
    mean, sd = float(draws.mean()), float(draws.std())
    smallest = 1e-12 * float(np.abs(draws).max())
    if np.ptp(draws) <= smallest:
        return Diagnosis(name, mean, 0.0, None, None, None, *draws.shape)
    if draws.shape[1] < 4:
        return Diagnosis(name, mean, sd, None, None, None, *draws.shape)
    arviz = import_arviz()
    with np.errstate(divide="ignore", invalid="ignore"):
        r_hat = _known(arviz.rhat(draws)) if len(draws) > 1 else None
        bulk, tail = (_known(arviz.ess(draws, method=part)) for part in ("bulk", "tail"))
    if np.all(np.ptp(draws, axis=1) <= smallest):
        r_hat = np.inf
    return Diagnosis(name, mean, sd, r_hat, bulk, tail, *draws.shape)


def _known(value: float) -> float | None:
    return None if np.isnan(value) else float(value)


def rank_counts(draws: Floats, bins: int = 20) -> NDArray[np.int64]:
    """(chains, bins) how the ranks of each chain's draws among all draws spread: the data of a rank plot.

    Chains that agree have about the same count in each bin. Ties get their mean rank.

    Args:
        draws: (chains, draws) of one quantity.
        bins: Bins of equal width.
    """
    from scipy.stats import rankdata

    ranks = rankdata(draws).reshape(draws.shape) - 1.0
    index = np.minimum((ranks * bins / draws.size).astype(np.int64), bins - 1)
    return np.stack([np.bincount(row, minlength=bins) for row in index])


def check_chains(fits: Sequence[Fit]) -> None:
    """Refuse fits that are not chains of one posterior.

    Raises:
        ValueError: There are none, or they differ in more than their draws.
    """
    if not fits:
        raise ValueError("chains need at least one fit")
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


def import_arviz() -> Any:
    """ArviZ, imported where it is used, for it takes seconds."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # It announces its next version at every import.
        import arviz
    return arviz
