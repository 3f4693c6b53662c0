"""The methods as data: which channel may explain which word of a sentence."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations, product
from typing import Literal, NamedTuple

import numpy as np

from model.data import Ints, Trials

Rule = Literal["distinct", "independent", "every"]


@dataclass(frozen=True)
class Method:
    """One of the compared methods (section 4.1 of the paper).

    Attributes:
        label: what tables call it.
        rule: how a sentence's frame F_d is limited. `distinct`: each channel explains at most one word
            (MEC-I and II), so F_d is an ordered choice of channels; `independent`: any channel for any word;
            `every`: there is no F_d, each channel explains the whole sentence.
    """

    label: str
    rule: Rule

    @property
    def hears_words(self) -> bool:
        """Whether the words are heard at all."""
        return self.label != "ALL"

    @property
    def has_frames(self) -> bool:
        """Whether the words have an estimated channel, and so an EAR."""
        return self.rule != "every"


METHODS: dict[str, Method] = {
    "proposed": Method("(A) proposed", "distinct"),
    "no_mec2": Method("(B) w/o MEC-II", "independent"),
    "mmlda": Method("(C) mMLDA", "every"),
    # Without words all methods are the same four mixtures; the paper's reference ALL.
    "gmm": Method("ALL", "every"),
}


class FrameList(NamedTuple):
    """The frames that a rule allows, by the number of words: the methods as data for compiled code.

    Attributes:
        frames: (frames, longest) the channel of each word, −1 behind the last.
        bounds: (longest + 2,) the frames of N words are rows bounds[N] to bounds[N + 1] − 1. A sentence
            longer than `longest` is sampled in consecutive parts of at most `longest` words.
    """

    frames: Ints
    bounds: Ints


@lru_cache
def distinct_frames(channels: int, words: int) -> Ints:
    """The C!/(C−N)! frames of N words over C channels in which no channel occurs twice, (frames, N)."""
    frames = list(permutations(range(channels), words))
    return np.array(frames, dtype=np.int64).reshape(len(frames), words)


@lru_cache
def frame_list(rule: Rule, channels: int, longest: int) -> FrameList:
    """The frames of 0 to `longest` words that a rule allows, each as probable as any other of its length.

    Args:
        rule: rule of the method; `every` has no frames.
        channels: C.
        longest: at most C for `distinct`.
    """
    by_length = []
    for words in range(longest + 1):
        if rule == "distinct":
            frames = distinct_frames(channels, words)
        else:
            rows = list(product(range(channels), repeat=words)) if rule == "independent" else []
            frames = np.array(rows, dtype=np.int64).reshape(len(rows), words)
        by_length.append(np.pad(frames, ((0, 0), (0, longest - words)), constant_values=-1))
    bounds = np.cumsum([0, *(len(frames) for frames in by_length)])
    return FrameList(np.ascontiguousarray(np.concatenate(by_length)), bounds.astype(np.int64))


def count_frames(rule: Rule, channels: int, words: int) -> float:
    """The number of frames that λ allows for a sentence of N words; 1 where there is no frame."""
    if rule == "distinct":
        return float(math.perm(channels, words))
    return float(channels) ** words if rule == "independent" else 1.0


def refuse_long_sentences(trials: Trials, rule: Rule) -> None:
    """Raise ValueError for trials whose sentence no frame of the method can explain."""
    if rule != "distinct":
        return
    limit = len(trials.channels)
    long = np.flatnonzero(trials.sentence_lengths > limit)
    if len(long):
        named = ", ".join(str(d) for d in long[:5])
        raise ValueError(
            f"{len(long)} sentences have more than {limit} words (rows {named} of the trials), but the proposed "
            f"method lets each of the {limit} channels explain one word only: shorten them or use no_mec2 or mmlda"
        )
