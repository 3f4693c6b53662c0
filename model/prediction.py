"""What a learned model makes of new scenes: instructions, equations (26) to (28), and descriptions, (30) to (32)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from model.data import Floats
from model.distributions.gaussian_densities import gaussian_log_density
from model.fits import Fit
from model.frame_paths import orders_of
from model.heard import Heard
from model.log_space import log_sum
from model.open_frames import Once
from model.state import State

# Of the methods that take the longest.
LONGEST_INSTRUCTION = Once.longest_instruction


@dataclass(frozen=True)
class Answer:
    """How a robot understands an instruction.

    Attributes:
        log_scores: (M, K_a) log p(words, A = m, z^a = k | objects): which object, and which action category.
        ignored: Words of the instruction that training never saw; they were left out.
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


def responsibilities(state: State, c: int, features: Floats) -> Floats:
    """(N, K) log r of channel c: the log posterior of the category given features alone, r_k ∝ π_k N(x | φ_k)."""
    rows = np.array(features, dtype=np.float64, order="C")
    joint = state.log_weights[c] + gaussian_log_density(rows, state.mean[c], state.factor[c])
    return np.asarray(joint - log_sum(joint))


def understand(fit: Fit, objects: Mapping[str, Floats], words: Sequence[str]) -> Answer:
    """Score every object and action category for an instruction, the frame F summed out.

    score(m, k) = (1/M) π^a_k Σ_f λ_f G_a(S_a) G_p(S_p) G_o(S_o) G_c(S_c), where the frame f sends the words S_x to
    channel x, G_a(S) = ∏ θ^a_{k,w}, and G_x(S) = Σ_j r_j ∏ θ^x_{j,w} for the features of object m. Where the fit's
    knowledge is of several states, the score is its mean over them.

    Args:
        fit: What was learned.
        objects: For each object channel the features (M, dim) of the objects on the table.
        words: The instruction: any number of words up to the `longest_instruction` of the method's frame prior, none
            included.

    Raises:
        ValueError: The instruction is too long, or there is no object.
    """
    M = len(next(iter(objects.values())))
    if M == 0:
        raise ValueError("no object on the table: an instruction needs at least one")
    longest = fit.problem.frame_prior.longest_instruction
    if len(words) > longest:
        raise ValueError(f"an instruction of {len(words)} words (at most {longest} are allowed)")
    known = [fit.trials.vocabulary.index(word) for word in words if word in fit.trials.vocabulary]
    ignored = tuple(word for word in words if word not in fit.trials.vocabulary)

    def log_scores(state: State) -> Floats:
        return fit.problem.frame_prior.log_scores(heard_as(fit, state, objects, known))

    return Answer(np.asarray(_averaged(fit, log_scores) - np.log(M)), ignored)


def heard_as(fit: Fit, state: State, objects: Mapping[str, Floats], known: Sequence[int]) -> Heard:
    """Known words, as indices into the vocabulary, as the categories of a state may have uttered them of objects."""
    channels = (0, *(fit.trials.index_of(channel) for channel in objects))
    spoken = [
        responsibilities(state, c, features) for c, features in zip(channels[1:], objects.values(), strict=True)
    ]
    columns = list(known)
    return Heard(
        weights=(state.log_weights[0], *spoken),
        words=tuple(state.log_words[c][:, columns] for c in channels),
        channels=channels,
        none=state.log_words[-1][0, columns] if fit.problem.frame_prior.has_none else np.empty(0),
        orders=state.log_orders,
        vocabulary=len(fit.trials.vocabulary),
    )


def describe(fit: Fit, channel: str, features: Floats) -> tuple[str, ...]:
    """The word that a channel most probably utters for each of N elements: argmax_w Σ_j r_j θ_{j,w}.

    Where the fit's knowledge is of several states, the sum is its mean over them.

    Args:
        fit: What was learned.
        channel: Action, or one of the object channels.
        features: (N, dim), scaled like the training features.

    Raises:
        ValueError: Training had no word.
    """
    if not fit.trials.vocabulary:
        raise ValueError("a description needs words, but training had none")
    c = fit.trials.index_of(channel)

    def log_p_of(state: State) -> Floats:
        weights = responsibilities(state, c, features)
        return np.asarray(log_sum(weights[:, None, :] + state.log_words[c].T[None])[..., 0])

    log_p = _averaged(fit, log_p_of)
    return tuple(fit.trials.vocabulary[int(w)] for w in np.argmax(log_p, axis=1))


def spoken_order(fit: Fit) -> tuple[str, ...] | None:
    """The names of all channels in the order in which they are most probably said; None where it is not learned."""
    states = fit.knowledge.states
    if not len(states[0].log_orders):
        return None
    names = [channel.name for channel in fit.trials.channels]
    share = np.mean([np.exp(state.log_orders) for state in states], axis=0)
    whole = [s for s, order in enumerate(orders_of(len(names))) if len(order) == len(names)]
    best = max(whole, key=lambda s: float(share[s]))  # the first of equals
    return tuple(names[c] for c in orders_of(len(names))[best])


def _averaged(fit: Fit, log_probability: Callable[[State], Floats]) -> Floats:
    """The logarithm of the mean of probabilities over the states that the tasks use."""
    values = [log_probability(state) for state in fit.knowledge.states]
    if len(values) == 1:
        return values[0]
    return np.asarray(log_sum(np.stack(values, axis=-1))[..., 0] - np.log(len(values)))
