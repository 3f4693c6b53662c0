"""Priors of frames: which channels may explain the words of a sentence, and how probable each frame F_d is."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations, product
from typing import ClassVar, NamedTuple

import numpy as np

from model.data import Flags, Floats, Ints, Trials
from model.frame_paths import Paths
from model.heard import Heard
from model.log_space import convolve_subsets, log_sum, subset_sizes


class FrameList(NamedTuple):
    """The frames that a prior allows, by the number of words, for compiled code.

    Attributes:
        frames: (frames, longest) the channel of each word, −1 behind the last.
        bounds: (longest + 2,) the frames of N words are rows bounds[N] to bounds[N + 1] − 1. A sentence
            longer than `longest` is sampled in consecutive parts of at most `longest` words.
        log_named: As `FramePrior.log_named` has it.
    """

    frames: Ints
    bounds: Ints
    log_named: Floats


@dataclass(frozen=True)
class FramePrior:
    """The prior of the frames of all sentences; here any channel explains any word, equation (1).

    Each allowed frame of a sentence is as probable as any other. Samplers, joint and tasks take all
    that they know of frames from here, so that another prior overrides what differs.

    A word of no channel, ∅, has the number of channels C for its frame, in F and wherever words' sources are counted.

    Attributes:
        has_frames: Whether the words have an estimated channel, and so an EAR.
        most_per_channel: How many words of a sentence a channel may explain.
        longest_instruction: Words of the longest instruction; scores of most priors are sums over subsets of them.
    """

    has_frames: ClassVar[bool] = True
    most_per_channel: ClassVar[float] = math.inf
    longest_instruction: ClassVar[int] = 12

    @property
    def has_none(self) -> bool:
        """Whether words may be of no channel."""
        return False

    def sources(self, channels: int) -> int:
        """Where words may come from: the channels, and ∅ behind them where there is one."""
        return channels + self.has_none

    def paths(self, channels: int, longest: int) -> Paths | None:
        """The states by which frames of up to `longest` words are drawn word by word; None where they are listed."""
        return None

    def log_named(self, channels: int, longest: int) -> Floats:
        """(longest + 1, longest + 1) log probability of a frame of N words, j of them with a channel.

        Of use where frames are listed and hang on nothing else; empty where all frames of N words are alike.
        """
        return np.empty((0, 0))

    def allowed(self, channels: int, words: int) -> Ints:
        """(frames, N) the frames of N words over C channels, here all C^N."""
        return rows_of(product(range(channels), repeat=words), words)

    def count(self, channels: int, words: int) -> float:
        """1/λ, the number of frames of N words over C channels; instructions may be longer than `word_limit`."""
        return float(channels) ** words

    def word_limit(self, channels: int) -> float:
        """How many words a sentence of the trials may have."""
        return math.inf

    def joint_words(self, longest: int, most: int) -> int:
        """How many words of a sentence are sampled together, given all others.

        Args:
            longest: Words of the longest sentence.
            most: What the sampler takes at a time where the prior factorises, so that long frames are never listed.
        """
        return min(longest, most)

    def listed(self, trials: Trials, most: int) -> FrameList:
        """The allowed frames of the words that are sampled together, see `joint_words`."""
        C, longest = len(trials.channels), max(1, trials.longest_sentence)
        allowed = _frame_list(self, C, self.joint_words(longest, most))
        return allowed._replace(log_named=self.log_named(C, longest))

    def draw(self, rng: np.random.Generator, trials: Trials) -> Ints:
        """Draw F (T,) from the prior."""
        return rng.integers(len(trials.channels), size=len(trials.word_trial))

    def log_probability(self, trials: Trials, F: Ints) -> float:
        """Log p(F) of allowed frames (T,)."""
        C = len(trials.channels)
        return -sum(n * float(np.log(self.count(C, N))) for N, n in trials.sentences_by_length.items())

    def explained(self, trials: Trials, F: Ints, c: int) -> Flags:
        """(T,) whether channel c explains each word."""
        return np.asarray(F == c)

    def counted(self, trials: Trials, F: Ints, c: int) -> Flags:
        """(T,) whether each word counts for θ of channel c: those that it explains."""
        return self.explained(trials, F, c)

    def log_scores(self, heard: Heard) -> Floats:
        """Sum over the frames of an instruction, equations (26) to (28).

        The sum is a convolution over subsets of the words, so that frames need not be listed.

        Returns:
            (M, K) log Σ_f λ_f G_a(S_a) G_p(S_p) …, where f sends the words S_x to channel x.
        """
        action, objects = heard.action_sets(), heard.object_sets()
        sizes = subset_sizes(action.shape[1])
        channels, words = 1 + len(objects), int(sizes[-1])
        total = np.tile(self._log_unexplained(heard, sizes), (len(objects[0]), 1))
        for sets in objects:
            total = convolve_subsets(total, self._within_limit(sets, sizes))
        complement = len(sizes) - 1 - np.arange(len(sizes))
        scores = log_sum(total[:, None, complement] + self._within_limit(action, sizes)[None])[..., 0]
        return np.asarray(scores - self._log_count(channels, words))

    def _log_count(self, channels: int, words: int) -> float:
        """Log 1/λ, by which sums over frames are divided."""
        return float(np.log(self.count(channels, words)))

    def _log_unexplained(self, heard: Heard, sizes: Ints) -> Floats:
        """(2^N,) the log probability of each subset of the words if no channel explains it."""
        return np.where(sizes == 0, 0.0, -np.inf)

    def _within_limit(self, sets: Floats, sizes: Ints) -> Floats:
        """The sets (rows, 2^N) with −inf for those that are too large for one channel."""
        return sets


class Distinct(FramePrior):
    """Each channel explains at most one word (MEC-I and II): F_d is an ordered choice of channels."""

    most_per_channel = 1

    def allowed(self, channels: int, words: int) -> Ints:
        """(C!/(C − N)!, N) the frames in which no channel occurs twice."""
        return rows_of(permutations(range(channels), words), words)

    def count(self, channels: int, words: int) -> float:
        """How many ways there are to pair words and channels until one of the two is used up."""
        return float(math.perm(max(channels, words), min(channels, words)))

    def word_limit(self, channels: int) -> float:
        """One word per channel."""
        return channels

    def joint_words(self, longest: int, most: int) -> int:
        """The whole sentence, since its words exclude each other's channels."""
        return longest

    def draw(self, rng: np.random.Generator, trials: Trials) -> Ints:
        """Draw F (T,), sentence by sentence."""
        frames = {N: self.allowed(len(trials.channels), N) for N in trials.sentences_by_length}
        chosen = [frames[N][rng.integers(len(frames[N]))] for N in trials.sentence_lengths if N > 0]
        return np.concatenate([np.empty(0, dtype=np.int64), *chosen])

    def _log_unexplained(self, heard: Heard, sizes: Ints) -> Floats:
        # Words beyond one per channel are explained by none, and have probability 1/W each.
        surplus = max(int(sizes[-1]) - len(heard.channels), 0)
        return np.where(sizes == surplus, -surplus * np.log(max(heard.vocabulary, 1)), -np.inf)

    def _within_limit(self, sets: Floats, sizes: Ints) -> Floats:
        return np.where(sizes <= 1, sets, -np.inf)


class Every(FramePrior):
    """There is no F_d: each channel explains the whole sentence."""

    has_frames = False

    def count(self, channels: int, words: int) -> float:
        """One way, in which there is nothing to choose."""
        return 1.0

    def draw(self, rng: np.random.Generator, trials: Trials) -> Ints:
        """An empty F."""
        return np.empty(0, dtype=np.int64)

    def explained(self, trials: Trials, F: Ints, c: int) -> Flags:
        """(T,) true."""
        return np.ones(len(trials.word_trial), dtype=np.bool_)

    def log_scores(self, heard: Heard) -> Floats:
        """(M, K) the log probability of all words under every channel."""
        action, objects = heard.action_sets(), heard.object_sets()
        everything = sum((sets[:, -1] for sets in objects), np.zeros(len(objects[0])))
        return np.asarray(everything[:, None] + action[:, -1])


class Unlearned(Every):
    """F is drawn at random at the start, any channel for any word, and never again; all words count for every θ.

    It is no prior of a model: z follows the words that F sends to its channel, θ follows all words.
    """

    draw = FramePrior.draw
    explained = FramePrior.explained
    counted = Every.explained


@lru_cache
def _frame_list(prior: FramePrior, channels: int, longest: int) -> FrameList:
    """List the frames of 0 to `longest` words."""
    by_length = [prior.allowed(channels, words) for words in range(longest + 1)]
    padded = [np.pad(rows, ((0, 0), (0, longest - rows.shape[1])), constant_values=-1) for rows in by_length]
    bounds = np.cumsum([0, *map(len, by_length)])
    return FrameList(np.ascontiguousarray(np.concatenate(padded)), bounds.astype(np.int64), np.empty((0, 0)))


def rows_of(frames: Iterable[tuple[int, ...]], words: int) -> Ints:
    """(frames, N) frames of N words as an array, also if there are none."""
    rows = list(frames)
    return np.array(rows, dtype=np.int64).reshape(len(rows), words)
