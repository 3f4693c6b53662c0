"""What the robot saw of the objects in each category of a fit (Figures 4C, 4D, 8C and 8D of the paper)."""

from __future__ import annotations

from functools import partial

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from data_collection.image_files import mosaic
from evaluation.figures.drawing import coarse, page
from evaluation.figures.fit import category_label
from evaluation.figures.source import Source
from features.percept_data import first, join, load_percepts
from model import Fit

CROPS_A_ROW = 12
GAP = 4
"""White pixels between crops."""


def _of_channel(channel: str, source: Source) -> Figure:
    """The crops in each category of a channel of the most probable fit."""
    _, fit, title = source.most_probable()
    percepts = join(map(load_percepts, source.files["percepts"]))
    return category_crops(fit, channel, first(percepts, source.settings["condition"]["D"]).crop, title)


object_categories = partial(_of_channel, "object")
color_categories = partial(_of_channel, "color")


def typical_first(fit: Fit, channel: str) -> dict[int, NDArray[np.int64]]:
    """The elements (objects) of each category in use of a channel, nearest to the category's mean first.

    Nearness is the Mahalanobis distance to the category's Gaussian.
    """
    c = fit.trials.index_of(channel)
    z, features = fit.state.z[c], fit.trials.channels[c].features
    ordered = {}
    for k in np.unique(z).tolist():
        own = np.flatnonzero(z == k)
        white = np.linalg.solve(fit.state.factor[c][k], (features[own] - fit.state.mean[c][k]).T)
        ordered[k] = own[np.argsort(np.linalg.norm(white, axis=0), kind="stable")]
    return ordered


def category_crops(fit: Fit, channel: str, crops: NDArray[np.uint8], title: str) -> Figure:
    """Draw the most typical crops of each category in use, a row per category.

    Args:
        fit: The fit.
        channel: `object` or `color`.
        crops: (N, H, W, 3) uint8 RGB, of the N objects of the fit's trials, in their order.
        title: Experiment and condition.

    Raises:
        ValueError: There is not one crop for each object.
    """
    c = fit.trials.index_of(channel)
    if len(crops) != len(fit.state.z[c]):
        raise ValueError(f"{len(crops)} crops of {len(fit.state.z[c])} objects; expected one for each object")
    rows = typical_first(fit, channel)
    cell = crops.shape[1] + GAP
    typical = [[coarse(crops[n]) for n in own[:CROPS_A_ROW]] for own in rows.values()]
    sheet = mosaic(typical, CROPS_A_ROW, (cell, cell))
    middles = cell * np.arange(len(rows)) + (cell - GAP) / 2
    with page(0.7 + 0.46 * len(rows)) as figure:
        axes = figure.subplots()
        axes.imshow(sheet, interpolation="nearest")
        axes.set_xticks([])
        axes.set_yticks(middles, [category_label(fit, c, i, k) for i, k in enumerate(rows)])
        counts = axes.secondary_yaxis("right")
        for side in (axes, counts):
            side.spines[:].set_visible(False)
            side.tick_params(length=0)
        counts.set_yticks(middles, [f"{len(own)}" for own in rows.values()])
        axes.set_title(
            f"{channel.capitalize()} categories: crops, most typical first, and number of objects\n{title}"
        )
    return figure
