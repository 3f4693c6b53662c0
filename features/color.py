"""Color feature: histogram of an object's pixels over colors learned by k-means (paper, section 4.2.1)."""

from __future__ import annotations

import logging

import numpy as np
from numpy.typing import NDArray

from features.threads import one_thread

log = logging.getLogger(__name__)

_STARTS = 10  # of k-means; the best is kept


def fit_codebook(
    pixels: list[NDArray[np.uint8]], colors: int, per_object: int, random: np.random.Generator
) -> NDArray[np.float64]:
    """Cluster the training objects' pixels.

    Args:
        pixels: RGB pixels (P, 3) of each training object.
        colors: Number of clusters; fewer if the pixels have fewer different values, with a warning.
        per_object: At most so many pixels of each object take part, drawn at random.
        random: Draws the pixels and the starts of k-means.

    Returns:
        float64 (colors, 3): the cluster centres in RGB, 0 to 255, in lexicographic order.
    """
    from sklearn.cluster import KMeans

    chosen = [one[np.sort(random.permutation(len(one))[:per_object])] for one in pixels]
    sample = np.concatenate(chosen).astype(np.float64)
    distinct = len(np.unique(sample, axis=0))
    if distinct < colors:
        log.warning("the training pixels have %d different colors: %d bins instead of %d", distinct, distinct, colors)
    means = KMeans(min(colors, distinct), n_init=_STARTS, random_state=int(random.integers(2**31)))
    with one_thread():
        means.fit(sample)
    centres = np.asarray(means.cluster_centers_, dtype=np.float64)
    return centres[np.lexsort(centres.T[::-1])]


def histogram(pixels: NDArray[np.uint8], codebook: NDArray[np.float64]) -> NDArray[np.float64]:
    """Give the share (colors,) of the pixels (P, 3) that are nearest to each color; it sums to 1."""
    if len(pixels) == 0:
        raise ValueError("an object without pixels has no color")
    distance = (codebook**2).sum(axis=1) - 2 * pixels.astype(np.float64) @ codebook.T
    counts = np.bincount(distance.argmin(axis=1), minlength=len(codebook))
    return np.asarray(counts / len(pixels), dtype=np.float64)
