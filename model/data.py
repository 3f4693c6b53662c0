"""What a sampler is given: the trials, as one list of elements per channel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Channel:
    """The elements of one sensory channel x.

    An element is what one category explains: an object on the table for position, object and
    color, a trial's action for action. The model knows no other difference between channels.

    Attributes:
        name: Name of the channel.
        features: (N, dim) one row per element.
        speaker: (D,) for each trial the element that its sentence is about: the attended object,
            or the trial's action.
    """

    name: str
    features: Floats
    speaker: Ints

    @property
    def dim(self) -> int:
        """The number of dimensions dim_x."""
        return int(self.features.shape[1])


@dataclass(frozen=True)
class Trials:
    """D trials: features per channel and the words heard.

    Attributes:
        channels: The channels, in the order in which frames number them.
        words: (C, T) index into the vocabulary of each of the T words, once for each channel. What
            was heard is one sentence, so the C rows are equal, except in data drawn from the model
            of method (C), where each channel utters a sentence of its own.
        word_trial: (T,) the trial d of each word, not decreasing.
        vocabulary: The W words.
    """

    channels: tuple[Channel, ...]
    words: Ints
    word_trial: Ints
    vocabulary: tuple[str, ...]

    def index_of(self, channel: str) -> int:
        """Which channel has this name, as frames number them.

        Raises:
            ValueError: No channel has it.
        """
        return [own.name for own in self.channels].index(channel)

    @property
    def count(self) -> int:
        """The number of trials D."""
        return len(self.channels[0].speaker)

    @cached_property
    def sentence_lengths(self) -> Ints:
        """(D,) the number of words N_d of each trial."""
        return np.bincount(self.word_trial, minlength=self.count).astype(np.int64)

    @cached_property
    def longest_sentence(self) -> int:
        """The largest N_d."""
        return int(self.sentence_lengths.max())

    @cached_property
    def sentences_by_length(self) -> dict[int, int]:
        """How many sentences there are of each length that occurs, shortest first."""
        lengths, counts = np.unique(self.sentence_lengths, return_counts=True)
        return {int(N): int(count) for N, count in zip(lengths, counts, strict=True)}

    @cached_property
    def sentence_bounds(self) -> Ints:
        """(D + 1,) the words of trial d are bounds[d] to bounds[d + 1] − 1."""
        return np.concatenate([[0], np.cumsum(self.sentence_lengths)]).astype(np.int64)

    @cached_property
    def word_speaker(self) -> tuple[Ints, ...]:
        """For each channel (T,) the element that utters each word, if the word's frame points at the channel."""
        return tuple(channel.speaker[self.word_trial] for channel in self.channels)

    @cached_property
    def words_by_element(self) -> tuple[tuple[Ints, Ints], ...]:
        """For each channel the words in the order of their elements (T,), and each element's bounds (N + 1,)."""
        result = []
        for channel, speaker in zip(self.channels, self.word_speaker, strict=True):
            order = np.argsort(speaker, kind="stable").astype(np.int64)
            bounds = np.searchsorted(speaker[order], np.arange(len(channel.features) + 1)).astype(np.int64)
            result.append((order, bounds))
        return tuple(result)

    @classmethod
    def from_arrays(
        cls,
        action: Floats,
        objects: Mapping[str, Floats],
        trial_of_object: Sequence[int] | Ints,
        attended: Sequence[int] | Ints,
        sentences: Sequence[Sequence[str]],
    ) -> Trials:
        """Build trials from plain arrays.

        Args:
            action: (D, dim_a) one action per trial.
            objects: For each object channel (N, dim_x), one row per object on any table.
            trial_of_object: (N,) the trial 0..D-1 of each object, not decreasing.
            attended: (D,) index 0..M_d-1 of the attended object A_d within its trial.
            sentences: The D sentences; their words make the vocabulary.

        Raises:
            ValueError: Shapes disagree, a value is not finite, or `attended` points nowhere.
        """
        action = np.array(action, dtype=np.float64, order="C")
        features = {name: np.array(rows, dtype=np.float64, order="C") for name, rows in objects.items()}
        owner = np.asarray(trial_of_object, dtype=np.int64)
        attention = np.asarray(attended, dtype=np.int64)
        D = len(action)
        per_trial = np.bincount(owner, minlength=D) if np.all(owner >= 0) else np.empty(0, dtype=np.int64)
        problems = _feature_problems({"action": (action, D)} | {x: (f, len(owner)) for x, f in features.items()})
        if D == 0 or len(attention) != D or len(sentences) != D or len(per_trial) != D:
            problems.append(
                f"{D} actions, but {len(attention)} attended objects, {len(sentences)} sentences and "
                f"objects of {len(per_trial)} trials: one of each is needed for each trial"
            )
        else:
            problems += [
                f"attended[{d}] = {attention[d]}, but trial {d} has {per_trial[d]} objects"
                for d in np.flatnonzero((attention < 0) | (attention >= per_trial))
            ]
        if np.any(np.diff(owner) < 0):
            problems.append("trial_of_object must not decrease: sort the objects by trial")
        if problems:
            raise ValueError("; ".join(problems))
        first_of_trial = np.cumsum(per_trial) - per_trial
        channels = [Channel("action", action, np.arange(D, dtype=np.int64))]
        channels += [Channel(name, rows, first_of_trial + attention) for name, rows in features.items()]
        vocabulary = tuple(sorted({word for sentence in sentences for word in sentence}))
        index = {word: i for i, word in enumerate(vocabulary)}
        tokens = np.array([index[word] for sentence in sentences for word in sentence], dtype=np.int64)
        word_trial = np.repeat(np.arange(D, dtype=np.int64), [len(sentence) for sentence in sentences])
        return cls(tuple(channels), np.tile(tokens, (len(channels), 1)), word_trial, vocabulary)

    def keep_words(self, kept: NDArray[np.bool_]) -> Trials:
        """Leave only the words t with kept[t]; the vocabulary stays as it is (docs/concepts.md, ROW)."""
        words = np.ascontiguousarray(self.words[:, kept])
        return Trials(self.channels, words, self.word_trial[kept], self.vocabulary)


def _feature_problems(expected: Mapping[str, tuple[Floats, int]]) -> list[str]:
    """What is wrong with features, given for each channel with the number of rows that they must have."""
    problems = []
    for name, (features, rows) in expected.items():
        if features.ndim != 2 or len(features) != rows or features.shape[1] == 0:
            problems.append(f"features of channel {name} are {features.shape}, not ({rows}, 1 or more)")
        elif not np.all(np.isfinite(features)):
            row = int(np.flatnonzero(~np.isfinite(features).all(axis=1))[0])
            problems.append(f"features of channel {name} are not all finite (row {row})")
    return problems
