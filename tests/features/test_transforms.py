"""Transforms fitted on the training trials: what they give, that they are artifacts, and their limits."""

from __future__ import annotations

import hashlib
import json
import logging
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from features.arrays import ArtifactError
from features.extraction_settings import FeatureSettings
from features.overview import overview
from features.percept_data import Percepts, first
from features.percepts import perceive
from features.table import read_metadata, read_table, write_table
from features.transforms import (
    apply,
    fit_transforms,
    load_transforms,
    relative_hand,
    save_transforms,
    table_metadata,
)

if TYPE_CHECKING:
    from pathlib import Path

SETTINGS = FeatureSettings.model_validate({"components": 6, "colors": 5})


@pytest.fixture(scope="module")
def percepts(logs: Any) -> Percepts:
    return perceive(logs.trials(12), logs.calibration(), SETTINGS)


def with_settings(**changes: Any) -> FeatureSettings:
    return FeatureSettings.model_validate(SETTINGS.model_dump() | changes)


def test_the_table_keeps_the_contract(percepts: Percepts, tmp_path: Path) -> None:
    transforms = fit_transforms(percepts, SETTINGS, 1, "simulator", 12)
    table = apply(transforms, percepts)
    paths = tmp_path / "trials.parquet", tmp_path / "objects.parquet"
    write_table(table, *paths, table_metadata(transforms, percepts))
    again = read_table(*paths, need_attention=True)
    np.testing.assert_array_equal(again.action, table.action)
    assert table.action.shape == (12, 38)
    assert table.object_feature.shape[1] == 6
    assert table.color.shape[1] == 5
    assert table.truth_object == percepts.truth_object
    metadata = read_metadata(paths[0])
    assert json.loads(metadata["action_names"]) == list(transforms.action_names)
    assert json.loads(metadata["provenance"])["trials"] == list(range(1, 13))
    assert json.loads(metadata["provenance"])["weights"] == "seeded 0"
    assert "dropped" not in metadata
    assert "attempts" not in metadata
    special = replace(percepts, dropped=("trial 3: why",), truth_attempts=np.arange(1, 13))
    metadata = table_metadata(transforms, special)
    assert json.loads(metadata["dropped"]) == ["trial 3: why"]
    assert json.loads(metadata["attempts"]) == list(range(1, 13))


def test_training_values_fill_the_unit_range(percepts: Percepts) -> None:
    table = apply(fit_transforms(percepts, SETTINGS, 1), percepts)
    assert (table.object_feature.min(), table.object_feature.max()) == (0.0, 1.0)
    ranges = fit_transforms(percepts, SETTINGS, 1)
    assert len(set(ranges.feature_lowest)) == len(set(ranges.feature_highest)) == 1  # keeps the relative spread
    assert np.ptp(table.object_feature, axis=0)[1:].max() < 1
    np.testing.assert_allclose([table.action[:, :2].min(axis=0), table.action[:, :2].max(axis=0)], [[0, 0], [1, 1]])
    assert table.action.min() >= 0
    assert table.action.max() <= 1


@pytest.mark.parametrize("scale", ["per_component", "none"])
def test_other_scales(percepts: Percepts, scale: str) -> None:
    plain = apply(fit_transforms(percepts, SETTINGS, 1), percepts).object_feature
    values = apply(fit_transforms(percepts, with_settings(scale=scale), 1), percepts).object_feature
    if scale == "per_component":
        np.testing.assert_allclose([values.min(axis=0), values.max(axis=0)], [np.zeros(6), np.ones(6)], atol=1e-12)
    else:
        np.testing.assert_allclose(values.mean(axis=0), 0, atol=1e-6)  # components as they are, about their mean
    np.testing.assert_allclose(abs(np.corrcoef(values[:, 0], plain[:, 0])[0, 1]), 1, atol=1e-9)


def test_components_keep_the_most_spread(percepts: Percepts) -> None:
    transforms = fit_transforms(percepts, SETTINGS, 1)
    np.testing.assert_allclose(transforms.pca_components @ transforms.pca_components.T, np.eye(6), atol=1e-9)
    centred = percepts.fc6.astype(np.float64) - transforms.pca_mean
    largest = np.linalg.svd(centred, compute_uv=False)[:6]
    np.testing.assert_allclose(np.linalg.norm(centred @ transforms.pca_components.T, axis=0), largest, rtol=1e-6)


def test_hand_target_leads_back_to_the_logged_hand(percepts: Percepts) -> None:
    transforms = fit_transforms(percepts, SETTINGS, 1)
    table = apply(transforms, percepts)
    target = transforms.hand_target(table.action, table.position[table.attended_row])
    np.testing.assert_allclose(target, percepts.hand, atol=1e-12)


def test_test_scenes_are_transformed_as_the_training_was(percepts: Percepts, logs: Any) -> None:
    training = first(percepts, 8)
    transforms = fit_transforms(training, SETTINGS, 1)
    alone, together = apply(transforms, training), apply(transforms, percepts)
    for name in ("action", "position", "object_feature", "color"):
        np.testing.assert_allclose(getattr(together, name)[: len(getattr(alone, name))], getattr(alone, name))
    instructions = apply(transforms, perceive(logs.trials(3, acted=False, first=50), logs.calibration(), SETTINGS))
    assert (instructions.action == 0).all()
    assert (instructions.attended_object >= 0).all()


def test_other_training_trials_give_other_transforms(percepts: Percepts) -> None:
    few, all_ = fit_transforms(first(percepts, 3), SETTINGS, 1), fit_transforms(percepts, SETTINGS, 1)
    for name in ("pca_mean", "codebook", "action_lowest", "feature_lowest"):
        assert not np.array_equal(getattr(few, name), getattr(all_, name)), name


def test_deleting_the_truth_leaves_the_same_features(percepts: Percepts) -> None:
    blind = replace(percepts, truth_action=None, truth_position=None, truth_object=None, truth_color=None)
    table, other = (apply(fit_transforms(part, SETTINGS, 1), part) for part in (percepts, blind))
    for name, value in vars(table).items():
        if not name.startswith("truth"):
            assert value.tobytes() == getattr(other, name).tobytes() if name != "words" else value == other.words


def test_saved_transforms_load_the_same_and_have_the_same_bytes(percepts: Percepts, tmp_path: Path) -> None:
    digests = set()
    for name in ("one.npz", "two.npz"):
        transforms = fit_transforms(percepts, SETTINGS, 1, "simulator", 12)
        save_transforms(tmp_path / name, transforms)
        digests.add(hashlib.sha256((tmp_path / name).read_bytes()).hexdigest())
    assert len(digests) == 1
    loaded = load_transforms(tmp_path / "one.npz")
    for name, value in vars(transforms).items():
        assert np.array_equal(value, getattr(loaded, name)), name
    np.load(tmp_path / "one.npz", allow_pickle=False)
    (tmp_path / "one.npz").write_bytes(b"PK")
    with pytest.raises(ArtifactError, match=r"one\.npz"):
        load_transforms(tmp_path / "one.npz")


def test_more_components_than_objects_are_said_and_cut(percepts: Percepts, caplog: pytest.LogCaptureFixture) -> None:
    objects = len(percepts.box)
    with caplog.at_level(logging.WARNING):
        transforms = fit_transforms(percepts, with_settings(components=65), 1)
    assert len(transforms.pca_components) == objects - 1
    assert f"{objects} training objects give {objects - 1} components instead of 65" in caplog.text


def test_one_object_in_all_training_trials(percepts: Percepts) -> None:
    rows = np.zeros(len(percepts.box), dtype=np.int64)
    alike = replace(percepts, fc6=percepts.fc6[rows], pixels=np.full_like(percepts.pixels, 90))
    table = apply(fit_transforms(alike, SETTINGS, 1), alike)
    assert np.isfinite(table.object_feature).all()
    assert np.ptp(table.object_feature, axis=0).max() < 1e-6 or (table.object_feature == 0).all()
    assert table.color.tolist() == [[1.0]] * len(rows)


def test_too_little_to_fit_on_is_refused(logs: Any, percepts: Percepts) -> None:
    single = 1 + int(np.bincount(percepts.trial_index).tolist().index(1))
    with pytest.raises(ValueError, match="1 trials with an action and 1 objects to fit on"):
        fit_transforms(perceive(logs.trials(1, first=single), logs.calibration(), SETTINGS), SETTINGS, 1)
    with pytest.raises(ValueError, match="0 trials with an action"):
        fit_transforms(perceive(logs.trials(2, acted=False), logs.calibration(), SETTINGS), SETTINGS, 1)


def test_relative_hand_without_an_object_is_relative_to_the_robot(percepts: Percepts) -> None:
    unknown = replace(percepts, attended_object=np.full(12, -1))
    np.testing.assert_allclose(relative_hand(unknown)[:, :2], percepts.hand[:, :2])


@pytest.mark.parametrize("known", [True, False])
def test_overview_holds_what_the_figure_shows(percepts: Percepts, known: bool) -> None:
    if not known:
        percepts = replace(percepts, truth_action=None, truth_object=None, truth_color=None)
    transforms = fit_transforms(percepts, SETTINGS, 1)
    table = apply(transforms, percepts)
    data = overview(percepts, transforms, table, groups=4)
    assert sum(len(boxes) for boxes in data.boxes) == len(table.position)
    assert (np.diff(data.crop_group) >= 0).all()
    assert set(data.crop_group) == {0, 1, 2, 3}
    assert sorted(crop.tobytes() for crop in data.crops) == sorted(crop.tobytes() for crop in percepts.crop)
    words = data.histogram_words
    assert words is None if not known else list(words or ()) == sorted(words or (), key=str)
    assert data.projections["object_feature"].shape == (len(table.position), 2)
    assert data.projections["action"].shape == (12, 2)
    assert data.codebook.dtype == np.uint8
