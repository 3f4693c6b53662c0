"""The methods as data: which channel may explain which word of a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations
from typing import Literal

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


@lru_cache
def distinct_frames(channels: int, words: int) -> Ints:
    """The C!/(C−N)! frames of N words over C channels in which no channel occurs twice, (frames, N)."""
    frames = list(permutations(range(channels), words))
    return np.array(frames, dtype=np.int64).reshape(len(frames), words)


def count_frames(rule: Rule, channels: int, words: int) -> float:
    """The number of frames that λ allows for a sentence of N words; 1 where there is no frame."""
    if rule == "distinct":
        return float(len(distinct_frames(channels, words)))
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
