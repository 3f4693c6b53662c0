"""Priors of frames for sentences as people say them: long, with words of no channel, in a learned order."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations, permutations, product
from typing import ClassVar

import numpy as np

from model.data import Floats, Ints, Trials
from model.frame_paths import Paths, counting_paths, log_named, paths_of
from model.frames import FramePrior, rows_of
from model.heard import Heard
from model.log_space import subset_log_products


class AnyOrNone(FramePrior):
    """Any channel or none explains any word: (B) with ∅.

    The number of words with a channel is uniform on 0 to N; then all frames of as many are alike.
    """

    @property
    def has_none(self) -> bool:
        """Always."""
        return True

    def allowed(self, channels: int, words: int) -> Ints:
        """(frames, N) all (C + 1)^N."""
        return rows_of(product(range(channels + 1), repeat=words), words)

    def count(self, channels: int, words: int) -> float:
        """(C + 1)^N."""
        return float(channels + 1) ** words

    def paths(self, channels: int, longest: int) -> Paths | None:
        """The numbers of words with a channel, of use where the word distributions are given."""
        return counting_paths(channels, longest)

    def log_named(self, channels: int, longest: int) -> Floats:
        """(longest + 1, longest + 1) log probability of a frame by its words and those with a channel."""
        return log_named(channels, longest)

    def draw(self, rng: np.random.Generator, trials: Trials) -> Ints:
        """Draw F (T,), sentence by sentence."""
        C, F = len(trials.channels), []
        for N in trials.sentence_lengths.tolist():
            named = rng.permutation(N)[: int(rng.integers(N + 1))]
            frame = np.full(N, C, dtype=np.int64)
            frame[named] = rng.integers(C, size=len(named))
            F.append(frame)
        return np.concatenate([np.empty(0, dtype=np.int64), *F])

    def log_probability(self, trials: Trials, F: Ints) -> float:
        """Log p(F) of frames (T,)."""
        C = len(trials.channels)
        named = np.bincount(trials.word_trial[C > F], minlength=trials.count)
        return float(log_named(C, trials.longest_sentence)[trials.sentence_lengths, named].sum())

    def _log_unexplained(self, heard: Heard, sizes: Ints) -> Floats:
        C, N = len(heard.channels), heard.length
        return np.asarray(subset_log_products(heard.none[None])[0] + log_named(C, N)[N, N - sizes])

    def _log_count(self, channels: int, words: int) -> float:
        # Frames are not alike: their probabilities are in `_log_unexplained`.
        return 0.0


@dataclass(frozen=True)
class Once(FramePrior):
    """Each channel explains at most one word: (A) with ∅, with a learned order of words, or with both.

    The number j of words with a channel is uniform on 0 to min(C, N) if words may be of no channel, and N if they may
    not. Which words have a channel is uniform. The order in which the sentence names its j channels is uniform, or
    has probabilities λ_j ~ Dir(δ / #orders, …) that all sentences share, integrated out.

    Attributes:
        none: Whether words may be of no channel.
        ordered: Whether the order of the channels is learned.
    """

    none: bool = False
    ordered: bool = False

    most_per_channel: ClassVar[float] = 1
    longest_instruction: ClassVar[int] = 40

    @property
    def has_none(self) -> bool:
        """As its attribute says."""
        return self.none

    def paths(self, channels: int, longest: int) -> Paths | None:
        """The states of sentences of up to `longest` words."""
        return paths_of(channels, longest, self.none, self.ordered)

    def allowed(self, channels: int, words: int) -> Ints:
        """(frames, N) every frame: for short sentences only, and needed by no sampler."""
        frames = []
        for j in range(min(channels, words) + 1) if self.none else (words,):
            for places in combinations(range(words), j):
                for order in permutations(range(channels), j):
                    frame = [channels] * words
                    for place, c in zip(places, order, strict=True):
                        frame[place] = c
                    frames.append(tuple(frame))
        return rows_of(frames, words)

    def count(self, channels: int, words: int) -> float:
        """How many frames there are; they are not alike in probability."""
        sizes = range(min(channels, words) + 1) if self.none else (min(channels, words),)
        return float(sum(math.comb(words, j) * math.perm(channels, j) for j in sizes))

    def word_limit(self, channels: int) -> float:
        """One word per channel, unless words may be of none."""
        return math.inf if self.none else channels

    def joint_words(self, longest: int, most: int) -> int:
        """The whole sentence, since its words exclude each other's channels."""
        return longest

    def draw(self, rng: np.random.Generator, trials: Trials) -> Ints:
        """Draw F (T,), sentence by sentence; a learned order by how often it has been drawn before."""
        C, F, said = len(trials.channels), [], dict[int, list[Ints]]()
        for N in trials.sentence_lengths.tolist():
            j = int(rng.integers(min(C, N) + 1)) if self.none else N
            earlier = said.setdefault(j, [])
            # With δ = 1, the first order of a number of channels is new, and the n-th with probability 1/n.
            old = int(rng.integers(len(earlier) + 1)) if self.ordered else len(earlier)
            order = earlier[old] if old < len(earlier) else rng.permutation(C)[:j]
            earlier.append(order)
            frame = np.full(N, C, dtype=np.int64)
            frame[np.sort(rng.permutation(N)[:j])] = order
            F.append(frame)
        return np.concatenate([np.empty(0, dtype=np.int64), *F])

    def log_probability(self, trials: Trials, F: Ints) -> float:
        """Log p(F) of allowed frames (T,)."""
        from model.kernels.frame_paths import frames_log_prior

        paths = paths_of(len(trials.channels), max(1, trials.longest_sentence), self.none, self.ordered)
        return float(frames_log_prior(paths, F, trials.sentence_bounds))

    def log_scores(self, heard: Heard) -> Floats:
        """(M, K) the sum over the frames of an instruction, along their states."""
        from model.kernels.answers import sums_of_answers

        C, N = len(heard.channels), heard.length
        paths = paths_of(C, N, self.none, self.ordered)
        objects = np.zeros((C, len(heard.weights[1]), N))
        for c, words in zip(heard.channels[1:], heard.object_words(), strict=True):
            objects[c] = words
        # Words beyond one per channel, where ∅ is no part of the model, have probability 1/W each.
        surplus = np.full(N, -math.log(max(heard.vocabulary, 1)) if N > C else -np.inf)
        none, action = (heard.none if self.none else surplus).copy(), heard.words[0].copy()
        if heard.only is not None:
            n, only = heard.only
            none[n] = -np.inf
            action[:, n] = action[:, n] if heard.channels[0] == only else -np.inf
            for c in heard.channels[1:]:
                objects[c, :, n] = objects[c, :, n] if c == only else -np.inf
        log_end = paths.log_prior[N] + (heard.orders if self.ordered else 0.0)
        sums = sums_of_answers(paths, heard.channels[0], action, objects, none, log_end)
        return np.asarray(heard.weights[0] + sums)
