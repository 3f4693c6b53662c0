"""Measures of a fit against the truth (section 4.2.1 of the paper). Each is None where it is not defined."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import adjusted_rand_score, confusion_matrix, f1_score

from evaluation.scores import NONE

Ints = NDArray[np.int64]
Truth = Sequence[str | None] | None


def adjusted_rand_index(z: Ints, truth: Truth) -> float | None:
    """Agreement of categories with true classes (Hubert and Arabie 1985), 1 if the same up to names, 0 by chance.

    Args:
        z: (N,) estimated categories.
        truth: (N,) true classes; elements of unknown class (None) are left out.

    Returns:
        The index, None where it is not defined: where no class is known, and where chance could not do otherwise, as
        with one element, or with both all alike or both all different (it is 0 / 0 then).
    """
    if truth is None:
        return None
    known = np.array([label is not None for label in truth], dtype=bool)
    labels = np.array([label for label in truth if label is not None])
    classes, categories = len(set(labels.tolist())), len(np.unique(z[known]))
    if len(labels) < 2 or classes == categories in (1, len(labels)):
        return None
    return float(adjusted_rand_score(labels, z[known]))


def estimation_accuracy_rate(F: Ints, channel_of_word: Sequence[int | None]) -> float | None:
    """EAR: the share of words whose estimated channel is the true one.

    Args:
        F: (T,) estimated channel of each word; empty for a method without frames.
        channel_of_word: (T,) true channel of each word; None for a word whose channel is unknown.

    Returns:
        The share, None for a method without frames and where no word was heard.
    """
    pairs = [(int(f), true) for f, true in zip(F, channel_of_word, strict=False) if true is not None]
    return float(np.mean([f == true for f, true in pairs])) if pairs else None


def channel_by_word(words: Mapping[str, Sequence[str]], channels: Sequence[str]) -> dict[str, int]:
    """The index of the true channel of each word of an experiment; of words of none, `NONE`, behind the channels."""
    return {word: [*channels, NONE].index(channel) for channel, own in words.items() for word in own}


def precision_and_recall(F: Ints, truth: Sequence[int | None], channel: int) -> tuple[float | None, float | None]:
    """Of the words that are estimated to be of a channel, the share that is; of those that are, the share estimated.

    Args:
        F: (T,) estimated channel of each word.
        truth: (T,) true channel; words whose channel is not known (None) are left out.
        channel: The channel, or C for none.

    Returns:
        Both shares, None where there is no such word.
    """
    pairs = [(int(f) == channel, true == channel) for f, true in zip(F, truth, strict=True) if true is not None]
    both = sum(found and is_so for found, is_so in pairs)
    found, so = sum(one for one, _ in pairs), sum(other for _, other in pairs)
    return (both / found if found else None), (both / so if so else None)


def accuracy(true: Sequence[str], predicted: Sequence[str]) -> float | None:
    """ACC: the share of words that are right; None without words."""
    if not true:
        return None
    return float(np.mean([t == p for t, p in zip(true, predicted, strict=True)]))


def f1_macro(true: Sequence[str], predicted: Sequence[str]) -> float | None:
    """F1: the mean over the words, of those that occur in truth or prediction; None without words.

    A word that is never predicted, or never true, counts 0.
    """
    if not true:
        return None
    labels = sorted({*true, *predicted})
    return float(f1_score(list(true), list(predicted), labels=labels, average="macro", zero_division=0))


def confusion(true: Sequence[str], predicted: Sequence[str], labels: Sequence[str]) -> Ints:
    """(W, W) how often each true word (row) was predicted as each word (column), in the order of `labels`."""
    return np.asarray(confusion_matrix(list(true), list(predicted), labels=list(labels)), dtype=np.int64)
