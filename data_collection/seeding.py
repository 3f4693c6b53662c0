"""Random generators that depend on names, never on the order in which they are made."""

import hashlib

import numpy as np


def generator(seed: int, *names: str | int) -> np.random.Generator:
    """Return the generator that belongs to a study's seed and a path of names.

    The names (stage, experiment, set, trial, …) are hashed, so that adding a condition changes no other draw.
    `generator(1, "a", 7)` and `generator(1, "a", "7")` differ, and so do `("ab",)` and `("a", "b")`.

    Args:
        seed: Seed of the study, not negative.
        names: Words and numbers that name what is drawn.
    """
    text = "\0".join(f"{type(name).__name__}:{name}" for name in names)
    digest = hashlib.sha256(text.encode()).digest()[:16]  # 128 bits: the size of SeedSequence's own pool
    return np.random.default_rng(np.random.SeedSequence([seed, int.from_bytes(digest, "big")]))
