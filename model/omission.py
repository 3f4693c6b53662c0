"""The rate of omitted words (ROW): which words of the training sentences the robot does not hear."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def kept_words(rng: np.random.Generator, words: int, rate: float) -> NDArray[np.bool_]:
    """(words,) whether each word is heard when `rate` per cent are omitted.

    The first round(rate/100 · words) of a random order are dropped, so that with the same generator a higher
    rate drops a superset.

    Args:
        rng: Generator named after the dataset and the seed, not after method or rate.
        words: Number of words of all trials.
        rate: ROW in per cent, 0 to 100.
    """
    if not 0 <= rate <= 100:
        raise ValueError(f"ROW = {rate} (must be 0 to 100)")
    kept = np.ones(words, dtype=bool)
    kept[rng.permutation(words)[: round(rate * words / 100)]] = False
    return kept
