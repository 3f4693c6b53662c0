"""Statistics of a dataset's features: of each episode, and of all of them.

LeRobot's tools take those of all from those of each when episodes are added, deleted, split off or merged, and its
newer policies scale by quantiles. So both are written, with the same names: minimum, maximum, mean, standard
deviation, five quantiles and the number of frames.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.lerobot.episodes import Episode
from data_collection.lerobot.features import IMAGE_KEY, SCALARS
from data_collection.log.messages import Floats

QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}
_LEVELS = np.arange(256) / 255.0
_IMAGE_SHAPE = (3, 1, 1)

Found = dict[str, dict[str, list[Any]]]
"""Statistics by feature and name, as plain lists; those of images have shape (3, 1, 1)."""


class Statistics:
    """What has been seen of each feature, an episode at a time."""

    def __init__(self) -> None:
        self._values: dict[str, list[Floats]] = {}
        self._levels: NDArray[np.int64] = np.zeros((3, 256), dtype=np.int64)
        self._frames = 0

    def add(self, episode: Episode, table: Any) -> Found:
        """Take in an episode and its table, and return the statistics of this episode alone."""
        scalars = {key: np.asarray(table[key].to_numpy(), dtype=np.float64)[:, None] for key in SCALARS}
        values = episode.vectors | scalars
        levels = _levels(episode)
        for key, own in values.items():
            self._values.setdefault(key, []).append(own)
        self._levels += levels
        self._frames += len(episode.shown)
        return _found({key: [own] for key, own in values.items()}, levels, len(episode.shown))

    def result(self) -> Found:
        """Return the statistics of all episodes, in the form of `stats.json`."""
        return _found(self._values, self._levels, self._frames)


def _found(values: dict[str, list[Floats]], levels: NDArray[np.int64], frames: int) -> Found:
    found = {key: _of_values(np.concatenate(parts)) for key, parts in values.items()}
    found[IMAGE_KEY] = _of_levels(levels)
    return {key: {name: value.tolist() for name, value in own.items()} | {"count": [frames]}
            for key, own in found.items()}  # fmt: skip


def _levels(episode: Episode) -> NDArray[np.int64]:
    """Return how many pixels of all frames have each level (3, 256) of red, green and blue."""
    shown, frames = np.unique(np.array(episode.shown), return_counts=True)
    counted = [count * _histogram(episode.pictures[i]) for i, count in zip(shown, frames, strict=True)]
    return np.asarray(np.sum(counted, axis=0), dtype=np.int64)


def _histogram(picture: NDArray[np.uint8]) -> NDArray[np.int64]:
    return np.stack([np.bincount(picture[..., channel].ravel(), minlength=256) for channel in range(3)])


def _of_values(values: Floats) -> dict[str, Floats]:
    """Return the statistics (n,) of frames (F, n)."""
    quantiles = np.quantile(values, list(QUANTILES.values()), axis=0)
    known = {
        "min": values.min(axis=0),
        "max": values.max(axis=0),
        "mean": values.mean(axis=0),
        "std": values.std(axis=0),
    }
    return known | dict(zip(QUANTILES, quantiles, strict=True))


def _of_levels(levels: NDArray[np.int64]) -> dict[str, Floats]:
    """Return the statistics (3, 1, 1) of pixels from 0 to 1, from how many have each level (3, 256)."""
    total = levels.sum(axis=1)
    mean = levels @ _LEVELS / total
    known = {
        "min": _LEVELS[(levels > 0).argmax(axis=1)],
        "max": _LEVELS[255 - (levels[:, ::-1] > 0).argmax(axis=1)],
        "mean": mean,
        "std": np.sqrt(np.maximum(levels @ _LEVELS**2 / total - mean**2, 0.0)),
    }
    known |= {name: _quantile(levels, share) for name, share in QUANTILES.items()}
    return {name: value.reshape(_IMAGE_SHAPE) for name, value in known.items()}


def _quantile(levels: NDArray[np.int64], share: float) -> Floats:
    reached = np.cumsum(levels, axis=1) >= share * levels.sum(axis=1, keepdims=True)
    return np.asarray(_LEVELS[np.argmax(reached, axis=1)])
