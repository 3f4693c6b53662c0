"""Which words the robot confuses when it tells what it did: counts over the seeds (Figures 6 and 10 of the paper)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from evaluation.metrics import confusion
from evaluation.scores import SEEDS


def word_order(words: Mapping[str, Sequence[str]], described: pd.DataFrame) -> list[str]:
    """The words of all channels, channel after channel; last those that the robot says but no channel has."""
    known = [word for own in words.values() for word in own]
    return known + sorted({*described["described"]} - {*known})


def count_confusions(described: pd.DataFrame, words: Mapping[str, Sequence[str]]) -> pd.DataFrame:
    """Count how often each true word was described as each word, over the seeds and trials of each condition.

    Args:
        described: What `evaluation.description.read_descriptions` gives.
        words: The words by channel; they give the order.

    Returns:
        Columns `SEEDS` of `evaluation.scores`, `true`, `described`, `count`: a row for each condition, in the order
        of `described`, and each two words in the order of `word_order`, also where the count is 0. The counts of a
        condition add up to its pairs.
    """
    labels = word_order(words, described)
    parts = []
    for condition, pairs in described.groupby(SEEDS, sort=False):
        counts = confusion(pairs["true"].tolist(), pairs["described"].tolist(), labels)
        names = dict(zip(SEEDS, condition, strict=True))
        part = {"true": np.repeat(labels, len(labels)), "described": np.tile(labels, len(labels))}
        parts.append(pd.DataFrame({**names, **part, "count": counts.ravel()}))
    return pd.concat(parts, ignore_index=True)


def of_method(counts: pd.DataFrame, method: str) -> pd.DataFrame:
    """The counts of one method at every D and ROW, of the first variant and sampler that it has."""
    own = counts[counts["method"] == method]
    first = [key for key in SEEDS if key not in ("D", "ROW")]
    same = (own[first] == own[first].iloc[0]).all(axis=1)
    return own[same]
