"""Statistics of a dataset's features, taken an episode at a time."""

from typing import Any

import numpy as np

from data_collection.lerobot.episodes import Episode
from data_collection.lerobot.features import IMAGE_KEY, SCALARS
from data_collection.log.messages import Floats


class Statistics:
    """Minimum, maximum, mean and standard deviation of every feature, one episode at a time."""

    def __init__(self) -> None:
        self._parts: dict[str, list[tuple[Floats, Floats, Floats, Floats, int]]] = {}

    def add(self, episode: Episode, table: Any) -> None:
        """Take in an episode and its table."""
        for key, values in episode.vectors.items():
            self._append(key, values)
        for key in SCALARS:
            self._append(key, np.asarray(table[key].to_numpy(), dtype=np.float64)[:, None])
        pixels = np.concatenate([episode.pictures[index].reshape(-1, 3) for index in sorted(set(episode.shown))])
        self._append(IMAGE_KEY, pixels / 255.0)

    def result(self) -> dict[str, dict[str, Any]]:
        """Return the statistics in the form of `stats.json`; those of images have shape (3, 1, 1)."""
        found: dict[str, dict[str, Any]] = {}
        for key, parts in self._parts.items():
            counts = np.array([part[4] for part in parts], dtype=np.float64)[:, None]
            total = counts.sum()
            mean = sum(part[2] for part in parts) / total
            variance = np.maximum(sum(part[3] for part in parts) / total - mean**2, 0.0)
            values = {
                "min": np.min([part[0] for part in parts], axis=0),
                "max": np.max([part[1] for part in parts], axis=0),
                "mean": mean,
                "std": np.sqrt(variance),
            }
            shape = (3, 1, 1) if key == IMAGE_KEY else (-1,)
            found[key] = {name: np.reshape(value, shape).tolist() for name, value in values.items()}
            found[key]["count"] = [int(total)]
        return found

    def _append(self, key: str, values: Floats) -> None:
        part = (values.min(axis=0), values.max(axis=0), values.sum(axis=0), (values**2).sum(axis=0), len(values))
        self._parts.setdefault(key, []).append(part)
