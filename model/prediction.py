"""What a learned model makes of new scenes: instructions, equations (26) to (28), and descriptions, (30) to (32)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.data import Floats, Ints
from model.distributions.dirichlet import log_sum
from model.fits import Fit
from model.frames import METHODS
from model.distributions.gaussian_densities import gaussian_log_density

LONGEST_INSTRUCTION = 12


@dataclass(frozen=True)
class Answer:
    """How a robot understands an instruction.

    Attributes:
        log_scores: (M, K_a) log p(words, A = m, z^a = k | objects): which object, and which action category.
        ignored: words of the instruction that training never saw; they were left out.
    """

    log_scores: Floats
    ignored: tuple[str, ...]

    @property
    def probabilities(self) -> Floats:
        """(M, K_a) p(A = m, z^a = k | words, objects)."""
        flat = self.log_scores.ravel()
        return np.asarray(np.exp(flat - log_sum(flat)).reshape(self.log_scores.shape))

    def choices(self) -> tuple[tuple[int, int], ...]:
        """The pairs (object, action category) with the highest score: one, or several that are tied."""
        best = np.isclose(self.log_scores, self.log_scores.max(), rtol=1e-12, atol=1e-9)
        return tuple((int(m), int(k)) for m, k in np.argwhere(best))


def responsibilities(fit: Fit, channel: str, features: Floats) -> Floats:
    """(N, K) log r: the log posterior of the category given features alone, r_k ∝ π_k N(x | φ_k)."""
    c = fit.trials.index_of(channel)
    rows = np.array(features, dtype=np.float64, order="C")
    joint = fit.state.log_weights[c] + gaussian_log_density(rows, fit.state.mean[c], fit.state.factor[c])
    return np.asarray(joint - log_sum(joint))


def understand(fit: Fit, objects: Mapping[str, Floats], words: Sequence[str]) -> Answer:
    """Score every object and action category for an instruction, the frame F summed out.

    score(m, k) = (1/M) π^a_k Σ_f λ_f G_a(S_a) G_p(S_p) G_o(S_o) G_c(S_c), where the frame f sends the words S_x to
    channel x, G_a(S) = ∏ θ^a_{k,w}, and G_x(S) = Σ_j r_j ∏ θ^x_{j,w} for the features of object m. The sum over
    the frames is a convolution over subsets of the words, so that frames need not be listed: a method that lets
    a channel explain one word only is one whose G is zero for larger sets.

    Args:
        fit: what was learned.
        objects: for each object channel the features (M, dim) of the objects on the table.
        words: the instruction: any number of words up to `LONGEST_INSTRUCTION`, none included.

    Raises:
        ValueError: the instruction is too long, or there is no object.
    """
    M = len(next(iter(objects.values())))
    if M == 0:
        raise ValueError("no object on the table: an instruction needs at least one")
    if len(words) > LONGEST_INSTRUCTION:
        raise ValueError(f"an instruction of {len(words)} words (at most {LONGEST_INSTRUCTION} are allowed)")
    known = [fit.trials.vocabulary.index(word) for word in words if word in fit.trials.vocabulary]
    ignored = tuple(word for word in words if word not in fit.trials.vocabulary)
    rule, N = METHODS[fit.method].rule, len(known)
    action = fit.state.log_weights[0][:, None] + _subset_log_products(fit.state.log_words[0][:, known])
    by_object = [_object_sets(fit, channel, features, known) for channel, features in objects.items()]
    if rule == "every":
        everything = sum((sets[:, -1] for sets in by_object), np.zeros(M))
        return Answer(everything[:, None] + action[:, -1] - np.log(M), ignored)
    channels = 1 + len(by_object)
    sizes = _sizes(N)
    if rule == "distinct":
        action = np.where(sizes <= 1, action, -np.inf)
        by_object = [np.where(sizes <= 1, sets, -np.inf) for sets in by_object]
        # Words beyond one a channel are explained by none, and have probability 1/W each.
        surplus = max(N - channels, 0)
        rest = np.where(sizes == surplus, -surplus * np.log(max(len(fit.trials.vocabulary), 1)), -np.inf)
        total = np.tile(rest, (M, 1))
        frames = float(np.prod(np.arange(max(N, channels), abs(N - channels), -1)))
    else:
        total = np.tile(np.where(sizes == 0, 0.0, -np.inf), (M, 1))
        frames = float(channels) ** N
    for sets in by_object:
        total = _convolve(total, sets)
    complement = (1 << N) - 1 - np.arange(1 << N)
    scores = log_sum(total[:, None, complement] + action[None])[..., 0]
    return Answer(np.asarray(scores - np.log(frames) - np.log(M)), ignored)


def describe(fit: Fit, channel: str, features: Floats) -> tuple[str, ...]:
    """The word that a channel most probably utters for each of N elements: argmax_w Σ_j r_j θ_{j,w}.

    Args:
        fit: what was learned.
        channel: action, or one of the object channels.
        features: (N, dim), scaled like the training features.

    Raises:
        ValueError: training had no word.
    """
    if not fit.trials.vocabulary:
        raise ValueError("a description needs words, but training had none")
    weights = responsibilities(fit, channel, features)
    log_p = log_sum(weights[:, None, :] + fit.state.log_words[fit.trials.index_of(channel)].T[None])[..., 0]
    return tuple(fit.trials.vocabulary[int(w)] for w in np.argmax(log_p, axis=1))


def _sizes(N: int) -> Ints:
    """(2^N,) the number of words in each subset; subset s holds word n where bit n of s is set."""
    return np.array([s.bit_count() for s in range(1 << N)], dtype=np.int64)


def _subset_log_products(log_words: Floats) -> Floats:
    """(K, 2^N) log ∏_{n ∈ S} θ_{k, w_n} of each subset S, from (K, N) log θ_{k, w_n}."""
    result = np.zeros((len(log_words), 1))
    for n in range(log_words.shape[1]):
        result = np.concatenate([result, result + log_words[:, n : n + 1]], axis=1)
    return result


def _object_sets(fit: Fit, channel: str, features: Floats, known: list[int]) -> Floats:
    """(M, 2^N) log G_x(S) of each object and subset of the words."""
    weights = responsibilities(fit, channel, features)
    products = _subset_log_products(fit.state.log_words[fit.trials.index_of(channel)][:, known])
    return np.asarray(log_sum(weights[:, None, :] + products.T[None])[..., 0])


def _convolve(left: Floats, right: Floats) -> Floats:
    """(M, 2^N) log Σ_{S ⊆ T} exp(left[S] + right[T ∖ S]) of each subset T."""
    count = left.shape[1]
    every = np.arange(count)
    result = np.full_like(left, -np.inf)
    for s in range(count):
        if np.all(np.isneginf(right[:, s])):
            continue
        apart = every[every & s == 0]
        result[:, apart | s] = np.logaddexp(result[:, apart | s], left[:, apart] + right[:, s : s + 1])
    return result
