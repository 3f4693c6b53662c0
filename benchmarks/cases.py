"""What is measured: fits of made-up trials, as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from model import METHODS, Blocked, Collapsed, Mixing, Sampler, Trials

# Dimensions of action, position, object and color in the paper's simulator experiment.
PAPER_DIMENSIONS = (38, 2, 30, 10)
SAMPLERS: dict[str, Sampler[Any]] = {
    "published": Blocked(),
    "released": Blocked(averaged_draws=100, empty_category="uniform"),
    "collapsed": Collapsed(),
    "mixing": Mixing(),
}


@dataclass(frozen=True)
class Case:
    """One fit to be measured.

    Attributes:
        series: What is varied, the name of a curve.
        size: Its value.
        method: Name of the method.
        sampler: Name of the sampler in `SAMPLERS`.
        trials: D; there are two objects per trial on average.
        categories: K.
        dimensions: Of the action and of each object channel.
        vocabulary: W.
        words: Words per sentence, at most one per channel.
        iterations: Sweeps of the fit.
        repetitions: How often it is measured; the fastest counts.
    """

    series: str
    size: int
    method: str = "proposed"
    sampler: str = "published"
    trials: int = 40
    categories: int = 10
    dimensions: tuple[int, ...] = PAPER_DIMENSIONS
    vocabulary: int = 14
    words: int = 4
    iterations: int = 200
    repetitions: int = 1


def make_trials(case: Case, seed: int = 1) -> Trials:
    """Trials in clusters, four per channel, features mostly in [0, 1], words by cluster."""
    rng = np.random.default_rng(seed)
    D, channels = case.trials, len(case.dimensions)
    count = rng.integers(1, 4, size=D)
    owner = np.repeat(np.arange(D), count)
    attended = rng.integers(count)
    speaker = np.cumsum(count) - count + attended
    labels = [rng.integers(4, size=D if c == 0 else len(owner)) for c in range(channels)]
    features = [
        rng.random((4, dim))[label] + 0.05 * rng.standard_normal((len(label), dim))
        for label, dim in zip(labels, case.dimensions, strict=True)
    ]
    spoken = [labels[0], *(label[speaker] for label in labels[1:])]
    sentences = [
        [f"word{(4 * c + int(spoken[c][d])) % case.vocabulary:04d}" for c in rng.permutation(channels)[: case.words]]
        for d in range(D)
    ]
    # The whole vocabulary occurs, however large it is.
    for w in range(case.vocabulary):
        if case.words:
            sentences[w % D][w % min(case.words, channels)] = f"word{w:04d}"
    objects = {f"channel{c}": features[c] for c in range(1, channels)}
    return Trials.from_arrays(features[0], objects, owner, attended, sentences)


def all_cases(quick: bool) -> Iterator[Case]:
    """Fits at the paper's sizes, a large one, and one series for each direction of growth."""
    paper = Case("paper", 40, iterations=10 if quick else 200, repetitions=1 if quick else 3)
    for sampler in SAMPLERS:
        for name, method in METHODS.items():
            if SAMPLERS[sampler].takes(method):
                yield replace(paper, sampler=sampler, method=name, words=4 if method.hears_words else 0)
    D = 400 if quick else 40_000
    yield Case("large", D, trials=D, iterations=5 if quick else 200)
    for sampler in ("published", "collapsed", "mixing"):
        start = Case("", 0, sampler=sampler, iterations=5 if quick else 20)
        for D in (40, 400) if quick else (40, 400, 4000, 40_000):
            yield replace(start, series="D", size=D, trials=D, iterations=max(5, start.iterations * 40 // D))
        for K in (10, 20) if quick else (10, 30, 100):
            yield replace(start, series="K", size=K, categories=K)
        for dim in (10, 30) if quick else (10, 30, 100, 500):
            yield replace(start, series="dimension", size=dim, dimensions=(38, 2, dim, 10), iterations=5)
        for W in (14, 50) if quick else (14, 140, 1400):
            yield replace(start, series="W", size=W, vocabulary=W, trials=400)
        for C in (2, 4) if quick else (2, 4, 6, 8):
            yield replace(start, series="channels", size=C, dimensions=(10,) * C, words=min(C, 4))
