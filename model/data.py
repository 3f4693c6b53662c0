"""What a sampler is given: the trials, as one element list a channel, and the priors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Channel:
    """The elements of one sensory channel x.

    An element is what one category explains: an object on the table for position, object and
    color, a trial's action for action. The model knows no other difference between channels.

    Attributes:
        name: name of the channel.
        features: (N, dim) one row an element.
        speaker: (D,) for each trial the element that its sentence is about: the attended object,
            or the trial's action.
    """

    name: str
    features: Floats
    speaker: Ints


@dataclass(frozen=True)
class Trials:
    """D trials: features per channel and the words heard.

    Attributes:
        channels: the channels, in the order in which frames number them.
        words: (C, T) index into the vocabulary of each of the T words, once for each channel. What
            was heard is one sentence, so the C rows are equal, except in data drawn from the model
            of method (C), where each channel utters a sentence of its own.
        word_trial: (T,) the trial d of each word, not decreasing.
        vocabulary: the W words.
    """

    channels: tuple[Channel, ...]
    words: Ints
    word_trial: Ints
    vocabulary: tuple[str, ...]

    @property
    def count(self) -> int:
        """The number of trials D."""
        return len(self.channels[0].speaker)

    @property
    def sentence_lengths(self) -> Ints:
        """(D,) the number of words N_d of each trial."""
        return np.bincount(self.word_trial, minlength=self.count).astype(np.int64)

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
            action: (D, dim_a) one action a trial.
            objects: for each object channel (N, dim_x), one row an object on any table.
            trial_of_object: (N,) the trial 0..D-1 of each object, not decreasing.
            attended: (D,) index 0..M_d-1 of the attended object A_d within its trial.
            sentences: the D sentences; their words make the vocabulary.

        Raises:
            ValueError: shapes disagree, a value is not finite, or `attended` points nowhere.
        """
        action = np.asarray(action, dtype=np.float64)
        owner = np.asarray(trial_of_object, dtype=np.int64)
        attention = np.asarray(attended, dtype=np.int64)
        D = len(action)
        per_trial = np.bincount(owner, minlength=D)
        if len(attention) != D or len(sentences) != D or len(per_trial) != D:
            raise ValueError(
                f"{D} actions, but {len(attention)} attended objects, {len(sentences)} sentences and "
                f"objects of {len(per_trial)} trials: one of each is needed for each trial"
            )
        if np.any(np.diff(owner) < 0):
            raise ValueError("trial_of_object must not decrease: sort the objects by trial")
        if np.any((attention < 0) | (attention >= per_trial)):
            wrong = int(np.flatnonzero((attention < 0) | (attention >= per_trial))[0])
            raise ValueError(
                f"attended[{wrong}] = {attention[wrong]}, but trial {wrong} has {per_trial[wrong]} objects"
            )
        first_of_trial = np.cumsum(per_trial) - per_trial
        channels = [Channel("action", action, np.arange(D, dtype=np.int64))]
        channels += [
            Channel(name, np.asarray(rows, dtype=np.float64), first_of_trial + attention)
            for name, rows in objects.items()
        ]
        for channel in channels:
            rows = D if channel.name == "action" else len(owner)
            if channel.features.ndim != 2 or len(channel.features) != rows:
                shape = channel.features.shape
                raise ValueError(f"features of channel {channel.name} are {shape}, not ({rows}, dimension)")
            if not np.all(np.isfinite(channel.features)):
                raise ValueError(f"features of channel {channel.name} are not all finite")
        vocabulary = tuple(sorted({word for sentence in sentences for word in sentence}))
        index = {word: i for i, word in enumerate(vocabulary)}
        tokens = np.array([index[word] for sentence in sentences for word in sentence], dtype=np.int64)
        word_trial = np.repeat(np.arange(D, dtype=np.int64), [len(sentence) for sentence in sentences])
        return cls(tuple(channels), np.tile(tokens, (len(channels), 1)), word_trial, vocabulary)

    def keep_words(self, kept: NDArray[np.bool_]) -> Trials:
        """Leave only the words t with kept[t]; the vocabulary stays as it is (model.md, section 2)."""
        return Trials(self.channels, self.words[:, kept], self.word_trial[kept], self.vocabulary)


@dataclass(frozen=True)
class Prior:
    """Hyperparameters of one channel, the paper's values as defaults (section 4.2.1).

    Attributes:
        categories: K, upper limit of the number of categories (weak limit).
        concentration: α of the mixture weights.
        mean: m0, the same number in every dimension.
        mean_strength: κ0, pseudo-observations behind m0.
        scale: V0 = scale · I.
        extra_freedom: ν0 − dim, more than −1.
        word_concentration: γ of the word distributions.
        box: interval from which the mean of an empty category is drawn where
            `empty_category` is `uniform`.
    """

    categories: int = 10
    concentration: float = 1.0
    mean: float = 0.0
    mean_strength: float = 0.001
    scale: float = 0.01
    extra_freedom: float = 2.0
    word_concentration: float = 0.1
    box: tuple[float, float] = (0.0, 1.0)

    def __post_init__(self) -> None:
        wrong = [
            f"{name} = {value} (must be {allowed})"
            for name, value, allowed, fine in (
                ("categories", self.categories, "at least 1", self.categories >= 1),
                ("concentration", self.concentration, "positive", self.concentration > 0),
                ("mean_strength", self.mean_strength, "positive", self.mean_strength > 0),
                ("scale", self.scale, "positive", self.scale > 0),
                ("extra_freedom", self.extra_freedom, "more than -1", self.extra_freedom > -1),
                ("word_concentration", self.word_concentration, "positive", self.word_concentration > 0),
            )
            if not fine
        ]
        if wrong:
            raise ValueError("hyperparameters: " + "; ".join(wrong))
