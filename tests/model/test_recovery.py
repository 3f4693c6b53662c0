"""Recovery of known categories and frames from well separated data."""

from __future__ import annotations

import numpy as np
import pytest
from sklearn.metrics import adjusted_rand_score

from model import Trials, fit
from model.data import Ints

WORDS = [[f"{channel}{k}" for k in range(3)] for channel in ("action", "position", "object", "color")]
DIMENSIONS = (6, 2, 8, 4)


def separated(rng: np.random.Generator, D: int) -> tuple[Trials, list[Ints], Ints]:
    """D trials of four words, the true categories of each channel and the true channel of each word.

    Three balanced categories a channel, their means at least six standard deviations apart.
    """
    count = rng.integers(1, 4, size=D)
    owner = np.repeat(np.arange(D), count)
    attended = np.array([rng.integers(m) for m in count])
    speaker = np.cumsum(count) - count + attended
    labels, features = [], []
    for c, dim in enumerate(DIMENSIONS):
        size = D if c == 0 else len(owner)
        labels.append(rng.permutation(np.arange(size) % 3))
        deviation = 0.05
        centres = np.zeros((3, dim))
        # Corners of an equilateral triangle in a random plane through the middle of the unit cube.
        angle = rng.uniform(0, 2 * np.pi) + 2 * np.pi * np.arange(3) / 3
        basis, _ = np.linalg.qr(rng.normal(size=(dim, 2)))
        centres += 0.5 + 8 * deviation / np.sqrt(3) * np.stack([np.cos(angle), np.sin(angle)], axis=1) @ basis.T
        features.append(centres[labels[-1]] + deviation * rng.normal(size=(size, dim)))
    sentences, frames = [], []
    for d in range(D):
        order = rng.permutation(4)
        spoken = [labels[0][d], *(labels[c][speaker[d]] for c in (1, 2, 3))]
        sentences.append([WORDS[c][spoken[c]] for c in order])
        frames.append(order)
    objects = dict(zip(("position", "object", "color"), features[1:], strict=True))
    return Trials.from_arrays(features[0], objects, owner, attended, sentences), labels, np.concatenate(frames)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["proposed", "no_mec2"])
def test_categories_and_frames_are_recovered(method: str) -> None:
    rates, indices = [], []
    for seed in range(20):
        trials, labels, frames = separated(np.random.default_rng(seed), D=60)
        state = fit(trials, method, np.random.default_rng(seed), inference="collapsed", chains=2).state
        rates.append(np.mean(state.F == frames))
        indices.append([adjusted_rand_score(true, z) for true, z in zip(labels, state.z, strict=True)])
    assert np.mean(rates) >= 0.95
    assert np.all(np.mean(indices, axis=0) >= 0.95)


def test_one_easy_data_set_is_recovered() -> None:
    trials, labels, frames = separated(np.random.default_rng(101), D=60)
    state = fit(trials, "proposed", np.random.default_rng(0), inference="collapsed", chains=2).state
    assert np.mean(state.F == frames) >= 0.95
    assert all(adjusted_rand_score(true, z) >= 0.95 for true, z in zip(labels, state.z, strict=True))
    scrambled = np.random.default_rng(1).permutation(state.F)
    assert np.mean(scrambled == frames) < 0.5
