"""The codebook of colors, and histograms over it."""

import logging

import numpy as np
import pytest

from features.color import fit_codebook, histogram

RED, GREEN, WHITE = (200, 20, 20), (20, 180, 30), (255, 255, 255)


def blob(color: tuple[int, int, int], count: int, seed: int, spread: float = 5.0) -> np.ndarray:
    noise = np.random.default_rng(seed).normal(0, spread, (count, 3))
    return np.clip(np.rint(np.array(color) + noise), 0, 255).astype(np.uint8)


def test_codebook_finds_the_colors_in_a_fixed_order() -> None:
    pixels = [blob(RED, 300, 1), blob(GREEN, 500, 2), blob(RED, 300, 3)]
    codebook = fit_codebook(pixels, 2, 200, np.random.default_rng(0))
    np.testing.assert_allclose(codebook, [GREEN, RED], atol=2)
    for seed in (1, 2):
        np.testing.assert_allclose(fit_codebook(pixels, 2, 200, np.random.default_rng(seed)), codebook, atol=2)
    again = fit_codebook(pixels, 2, 200, np.random.default_rng(0))
    assert again.tobytes() == codebook.tobytes()


def test_fewer_colors_than_bins_are_said_and_done(caplog: pytest.LogCaptureFixture) -> None:
    pixels = [np.array([RED] * 50 + [WHITE] * 50, dtype=np.uint8)]
    with caplog.at_level(logging.WARNING):
        codebook = fit_codebook(pixels, 10, 500, np.random.default_rng(0))
    np.testing.assert_allclose(codebook, [RED, WHITE])
    assert "2 different colors" in caplog.text


def test_histogram_sums_to_one_and_counts_shares() -> None:
    codebook = np.array([GREEN, RED, WHITE], dtype=np.float64)
    pixels = np.vstack([blob(RED, 60, 1), blob(WHITE, 40, 2)])
    np.testing.assert_allclose(histogram(pixels, codebook), [0.0, 0.6, 0.4])
    with pytest.raises(ValueError, match="without pixels"):
        histogram(np.zeros((0, 3), dtype=np.uint8), codebook)


def test_shaded_and_saturated_pixels_stay_nearest_to_their_color() -> None:
    codebook = np.array([GREEN, RED, WHITE, (30, 50, 220)], dtype=np.float64)
    shades = np.array([[90, 5, 5], [255, 30, 25], [140, 10, 15]], dtype=np.uint8)  # in shadow, in the light
    assert histogram(shades, codebook)[1] == 1.0
    glare = np.array([[255, 255, 255], [250, 252, 251]], dtype=np.uint8)
    assert histogram(glare, codebook)[2] == 1.0
