"""An instruction as a learned state might have uttered it, of which priors of frames make scores."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from model.data import Floats
from model.log_space import log_sum, subset_log_products


class Heard(NamedTuple):
    """The words of an instruction under each category, and how probable the categories are for M objects.

    Attributes:
        weights: For the action (K,) log π, then for each object channel (M, K) log r, given the features.
        words: For each channel (K, N) log θ of the words.
        channels: The channels' numbers, the action's first.
        none: (N,) log θ of no channel; (0,) where every word has one.
        orders: (S,) log λ; (0,) where it is not learned.
        vocabulary: W.
        only: (n, c) if only the frames count that send word n to channel c.
    """

    weights: tuple[Floats, ...]
    words: tuple[Floats, ...]
    channels: tuple[int, ...]
    none: Floats
    orders: Floats
    vocabulary: int
    only: tuple[int, int] | None = None

    @property
    def length(self) -> int:
        """N."""
        return int(self.words[0].shape[1])

    def action_sets(self) -> Floats:
        """(K, 2^N) log probability of each subset of the words under each action category."""
        return self._holding(0, self.weights[0][:, None] + subset_log_products(self.words[0]))

    def object_sets(self) -> list[Floats]:
        """For each object channel (M, 2^N) log G_x(S) of each object and subset of the words."""
        return [self._holding(x, self._object_sets(x)) for x in range(1, len(self.words))]

    def _object_sets(self, x: int) -> Floats:
        products = subset_log_products(self.words[x])
        return np.asarray(log_sum(self.weights[x][:, None, :] + products.T[None])[..., 0])

    def _holding(self, x: int, sets: Floats) -> Floats:
        """The sets with −inf for those that lack a word which only this channel may explain."""
        if self.only is None or self.channels[x] != self.only[1]:
            return sets
        holds = (np.arange(sets.shape[1]) >> self.only[0]) & 1 == 1
        return np.where(holds, sets, -np.inf)

    def object_words(self) -> list[Floats]:
        """For each object channel (M, N) log probability of each single word for each object."""
        pairs = zip(self.weights[1:], self.words[1:], strict=True)
        return [np.asarray(log_sum(weights[:, None, :] + words.T[None])[..., 0]) for weights, words in pairs]
