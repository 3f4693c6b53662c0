"""What is fitted on the D training trials and applied to all scenes: components, colors, scales.

The fitted transforms are an artifact of their own (npz), so that test scenes go through those of the training.
"""

from __future__ import annotations

import json
import logging
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.seeding import generator
from features.action import Scale, action_names, fit_action_scale, hand_target, within_limits
from features.arrays import load_arrays, save_arrays
from features.color import fit_codebook, histogram
from features.extraction_settings import FeatureSettings
from features.object_feature import weights_provenance
from features.percept_data import Percepts
from features.table import FeatureTable
from features.threads import one_thread

log = logging.getLogger(__name__)

Array = NDArray[np.float64]

LEAST_OBJECTS = 2
"""So many objects are needed to fit on."""


@dataclass(frozen=True, eq=False)
class Transforms:
    """The transforms fitted on the training trials of one condition.

    Attributes:
        pca_mean: float64 (4096,), mean of fc6.
        pca_components: float64 (C, 4096), orthonormal rows, by falling variance.
        feature_lowest, feature_highest: float64 (C,), values of the components that become 0 and 1.
        codebook: float64 (colors, 3), the colors of the histogram's bins, RGB 0 to 255.
        action_lowest, action_highest: float64 (dim_a,), raw action values that become 0 and 1.
        action_names: (dim_a,), names of the action's numbers.
        table_height: float64 (), z of the table, metres, robot frame.
        provenance: JSON of settings, weights, seed and training trials.
    """

    pca_mean: Array
    pca_components: Array
    feature_lowest: Array
    feature_highest: Array
    codebook: Array
    action_lowest: Array
    action_highest: Array
    action_names: tuple[str, ...]
    table_height: Array
    provenance: str

    @property
    def action_scale(self) -> Scale:
        """The action's scaling and its inverse."""
        return Scale(self.action_lowest, self.action_highest)

    def hand_target(self, action: Array, object_position: Array) -> Array:
        """Return where an action (…, dim_a) at an object (…, 2) puts the hand: (…, 3), metres, robot frame."""
        return hand_target(self.action_scale, action, object_position, float(self.table_height))


def fit_transforms(percepts: Percepts, settings: FeatureSettings, seed: int, *names: str | int) -> Transforms:
    """Fit all transforms on training trials.

    Args:
        percepts: The D training trials of the condition.
        settings: How many components and colors, and which scale.
        seed: The study's seed.
        names: Names of the condition (experiment, D); with the seed they determine the draws.

    Raises:
        ValueError: No trial in which an action was executed, or fewer than two objects.
    """
    acted = percepts.acted & (percepts.attended_object >= 0)
    if not acted.any() or len(percepts.box) < LEAST_OBJECTS:
        raise ValueError(
            f"{int(acted.sum())} trials with an action and {len(percepts.box)} objects to fit on; "
            f"expected at least 1 trial and {LEAST_OBJECTS} objects"
        )
    with one_thread():
        mean, components = _principal_components(percepts.fc6.astype(np.float64), settings.components)
        lowest, highest = _ranges((percepts.fc6 - mean) @ components.T, settings.scale)
        pixels = np.split(percepts.pixels, np.searchsorted(percepts.pixel_index, range(1, len(percepts.box))))
        random = generator(seed, "features", "codebook", *names)
        codebook = fit_codebook(pixels, settings.colors, settings.color_pixels, random)
    scale = fit_action_scale(relative_hand(percepts)[acted], percepts.joint_lower, percepts.joint_upper)
    # The path of a weights file means nothing elsewhere; its content does.
    told = settings.model_dump(exclude={"weights"})
    provenance = {
        "settings": told,
        "weights": weights_provenance(settings),
        "seed": seed,
        "names": names,
        "trials": percepts.trial.tolist(),
    }
    return Transforms(
        pca_mean=mean,
        pca_components=components,
        feature_lowest=lowest,
        feature_highest=highest,
        codebook=codebook,
        action_lowest=scale.lowest,
        action_highest=scale.highest,
        action_names=action_names(percepts.joint_names),
        table_height=percepts.table_height,
        provenance=json.dumps(provenance, sort_keys=True),
    )


def _principal_components(values: Array, components: int) -> tuple[Array, Array]:
    """Return mean and the leading components of rows of values; as many as the rows allow."""
    from sklearn.decomposition import PCA

    allowed = len(values) - 1
    if components > allowed:
        log.warning("%d training objects give %d components instead of %d", len(values), allowed, components)
    with np.errstate(invalid="ignore"):  # shares of a variance of zero, which are not used
        pca = PCA(min(components, allowed), svd_solver="full").fit(values)
    return np.asarray(pca.mean_, dtype=np.float64), np.asarray(pca.components_, dtype=np.float64)


def _ranges(values: Array, scale: str) -> tuple[Array, Array]:
    """Return the values that become 0 and 1 in each column (by default one range for all columns, our choice)."""
    if scale == "none":
        return np.zeros(values.shape[1]), np.ones(values.shape[1])
    if scale == "per_component":
        return values.min(axis=0), values.max(axis=0)
    return np.full(values.shape[1], values.min()), np.full(values.shape[1], values.max())


def relative_hand(percepts: Percepts) -> Array:
    """Return the hand relative to the attended object, (D, 3); without one, to x = y = 0 on the table."""
    count = np.searchsorted(percepts.trial_index, np.arange(len(percepts.trial)))
    known = percepts.attended_object >= 0
    rows = np.where(known, count + percepts.attended_object, 0)
    ground = np.where(known[:, None], percepts.position[rows], 0.0)
    return np.asarray(percepts.hand - np.column_stack([ground, np.full(len(ground), percepts.table_height)]))


def apply(transforms: Transforms, percepts: Percepts) -> FeatureTable:
    """Make the feature table of some trials.

    The action of a trial in which none was executed (instructions) is all zeros.

    Raises:
        ValueError: All trials were dropped.
    """
    if not len(percepts.trial):
        raise ValueError("\n".join(["no trial is left", *percepts.dropped]))
    raw = np.column_stack([relative_hand(percepts), percepts.finger_rate, percepts.joints, percepts.touch])
    scaled = np.where(percepts.acted[:, None], transforms.action_scale.scale(raw), 0.0)
    with one_thread():
        components = (percepts.fc6 - transforms.pca_mean) @ transforms.pca_components.T
    scale = Scale(transforms.feature_lowest, transforms.feature_highest)
    starts = np.searchsorted(percepts.pixel_index, np.arange(1, len(percepts.box)))
    color = [histogram(pixels, transforms.codebook) for pixels in np.split(percepts.pixels, starts)]
    kept = {item.name: getattr(percepts, item.name) for item in fields(FeatureTable) if hasattr(percepts, item.name)}
    return FeatureTable(
        action=within_limits(scaled, transforms.action_names, percepts.trial),
        object_feature=scale.scale(components),
        color=np.stack(color),
        **kept,
    )


def table_metadata(transforms: Transforms, percepts: Percepts) -> dict[str, str]:
    """Return the metadata of the Parquet files: the action's names and scaling, and the provenance.

    Beside these, why trials of the set are missing, and how often each trial of a fair test set was tried.

    Args:
        transforms: The transforms that the table was made with.
        percepts: Of the trials of the table.
    """
    dropped, attempts = percepts.dropped, percepts.truth_attempts
    special = {"dropped": json.dumps(list(dropped), ensure_ascii=False)} if dropped else {}
    special |= {} if attempts is None else {"attempts": json.dumps(attempts.tolist())}
    return special | {
        "action_names": json.dumps(transforms.action_names),
        "action_lowest": json.dumps(transforms.action_lowest.tolist()),
        "action_highest": json.dumps(transforms.action_highest.tolist()),
        "position_unit": "metres on the table, robot frame (x ahead, y left)",
        "provenance": transforms.provenance,
    }


def save_transforms(path: Path, transforms: Transforms) -> None:
    """Write transforms as npz; the same transforms give the same bytes."""
    arrays = {name: np.asarray(value) for name, value in vars(transforms).items()}
    save_arrays(path, "transforms", arrays)


def load_transforms(path: Path) -> Transforms:
    """Read what `save_transforms` wrote.

    Raises:
        ArtifactError: The file is missing, damaged or something else.
    """
    arrays: dict[str, Any] = load_arrays(path, "transforms", tuple(item.name for item in fields(Transforms)))
    arrays["action_names"] = tuple(str(name) for name in np.ravel(arrays["action_names"]))
    return Transforms(**arrays | {"provenance": str(arrays["provenance"])})
