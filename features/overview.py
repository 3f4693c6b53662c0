"""The data of the overview figure of an experiment's features; drawing is elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from features.percept_data import Percepts
from features.table import FeatureTable, Texts
from features.threads import one_thread
from features.transforms import Transforms

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Overview:
    """Data of one figure per experiment; N objects in D trials, G groups of objects.

    Attributes:
        trial: int64 (D,), numbers of the trials; their `image_before` belongs under the boxes.
        boxes: D arrays int64 (M_d, 4), left, top, right, bottom of the detections in the image, pixels.
        attended: int64 (D,), which of them is attended, −1 where unknown.
        crops: uint8 (N, 64, 64, 3) RGB, sorted by group and, inside a group, by nearness to its centre.
        crop_group: int64 (N,), group (0..G−1) of each crop: k-means of the object feature.
        codebook: uint8 (colors, 3), the colors of the histogram's bins, RGB.
        histograms: float64 (N, colors), sorted by true color word where known.
        histogram_words: True color word of each histogram, or None.
        actions: float64 (D, dim_a), sorted by true action word where known.
        action_words: True action word of each row of `actions`, or None.
        action_names: (dim_a,) names of the columns of `actions`.
        projections: For `object_feature`, `color` and `action` the first two principal components, (N or D, 2).
        projection_words: The true words that color the points of each projection, or None.
    """

    trial: NDArray[np.int64]
    boxes: tuple[NDArray[np.int64], ...]
    attended: NDArray[np.int64]
    crops: NDArray[np.uint8]
    crop_group: NDArray[np.int64]
    codebook: NDArray[np.uint8]
    histograms: Array
    histogram_words: Texts | None
    actions: Array
    action_words: Texts | None
    action_names: tuple[str, ...]
    projections: dict[str, Array]
    projection_words: dict[str, Texts | None]


def overview(percepts: Percepts, transforms: Transforms, table: FeatureTable, groups: int) -> Overview:
    """Collect what the overview figure of an experiment shows.

    Args:
        percepts: Percepts of some trials.
        transforms: The transforms fitted on the training trials.
        table: `apply(transforms, percepts)`.
        groups: Number of groups into which k-means sorts the crops; at most the number of objects.
    """
    from sklearn.cluster import KMeans

    with one_thread():
        means = KMeans(min(groups, len(table.position)), n_init=10, random_state=0).fit(table.object_feature)
        views = {"object_feature": table.object_feature, "color": table.color, "action": table.action}
        projections = {name: _projection(values) for name, values in views.items()}
    distance = np.linalg.norm(table.object_feature - means.cluster_centers_[means.labels_], axis=1)
    order = np.lexsort((distance, means.labels_))
    by_color, by_action = (
        _by_word(table.truth_color, len(table.color)),
        _by_word(table.truth_action, len(table.trial)),
    )
    return Overview(
        trial=table.trial,
        boxes=tuple(np.split(percepts.box, table.first_object[1:])),
        attended=table.attended_object,
        crops=percepts.crop[order],
        crop_group=means.labels_[order].astype(np.int64),
        codebook=np.rint(transforms.codebook).astype(np.uint8),
        histograms=table.color[by_color],
        histogram_words=_pick(table.truth_color, by_color),
        actions=table.action[by_action],
        action_words=_pick(table.truth_action, by_action),
        action_names=transforms.action_names,
        projections=projections,
        projection_words={
            "object_feature": table.truth_object,
            "color": table.truth_color,
            "action": table.truth_action,
        },
    )


def _projection(values: Array) -> Array:
    """Return the first two principal components (n, 2); zeros where there are not as many."""
    left, spread, _ = np.linalg.svd(values - values.mean(axis=0), full_matrices=False)
    scores = (left * spread)[:, :2]
    return np.pad(scores, ((0, 0), (0, 2 - scores.shape[1])))


def _by_word(words: Texts | None, count: int) -> NDArray[np.int64]:
    """Return the order that sorts by word, unknown ones last, and is stable otherwise."""
    keys = [(word is None, word or "") for word in words or (None,) * count]
    return np.array(sorted(range(count), key=keys.__getitem__), dtype=np.int64)


def _pick(words: Texts | None, order: NDArray[np.int64]) -> Texts | None:
    """Return the words in an order."""
    return None if words is None else tuple(words[i] for i in order)
