"""Detection, homography and position on drawn scenes whose truth is known."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from features.detection import CROP_SIZE, Found, crop, detect, without_rim
from features.extraction_settings import Detection
from features.homography import CalibrationError, find_marks, fit_camera, to_pixels, to_table
from features.position import standing_position

NO_DISTORTION = np.zeros(0)
SETTINGS = Detection()


@pytest.fixture(scope="module")
def solid(scene: Any) -> Any:
    """The class of drawn solids, which comes with the scene."""
    import inspect

    return inspect.getmodule(type(scene)).Solid


@pytest.fixture(scope="module")
def camera(scene: Any) -> Any:
    return fit_camera(scene.on_table(scene.marks), scene.marks, scene.matrix, NO_DISTORTION)


def overlap(one: np.ndarray, other: np.ndarray) -> float:
    return float((one & other).sum() / (one | other).sum())


def three(solid: Any) -> list[Any]:
    return [
        solid("box", 0.22, 0.0, (30, 60, 220), turn=0.3),
        solid("cup", 0.29, 0.13, (20, 160, 40)),
        solid("ball", 0.30, -0.15, (200, 30, 30)),
    ]


@pytest.mark.parametrize(
    "conditions",
    [{}, {"noise": 4.0}, {"shadow": 0.55}, {"light": 0.85}, {"light": 1.05, "noise": 2.0, "shadow": 0.6}],
    ids=str,
)
def test_finds_every_object_and_no_other(scene: Any, solid: Any, conditions: dict[str, float]) -> None:
    solids = three(solid)
    found = detect(scene.image(solids, **conditions), scene.empty(), SETTINGS)
    assert len(found) == 3
    expected = [scene.mask(solids[i]) for i in (1, 0, 2)]  # from left to right
    assert all(overlap(one.mask, true) > 0.93 for one, true in zip(found, expected, strict=True))


@pytest.mark.parametrize("conditions", [{}, {"noise": 6.0}, {"light": 0.8, "noise": 3.0}], ids=str)
def test_finds_nothing_on_the_empty_table(scene: Any, conditions: dict[str, float]) -> None:
    assert detect(scene.image([], **conditions), scene.empty(), SETTINGS) == ()


def test_a_shadow_alone_is_no_object_but_a_dark_thing_is(scene: Any) -> None:
    for brightness, count in ((0.6, 0), (0.2, 1)):
        image = scene.empty().copy()
        image[100:140, 100:150] = (image[100:140, 100:150] * brightness).astype(np.uint8)
        assert len(detect(image, scene.empty(), SETTINGS)) == count


def test_cuts_apart_what_touches_in_the_image(scene: Any, solid: Any) -> None:
    pair = [solid("ball", 0.29, 0.03), solid("ball", 0.29, -0.026)]
    image = scene.image(pair)
    found = detect(image, scene.empty(), SETTINGS)
    assert [overlap(one.mask, scene.mask(true)) > 0.85 for one, true in zip(found, pair, strict=True)] == [True] * 2
    assert len(detect(image, scene.empty(), Detection(neck=0.0))) == 1


@pytest.mark.parametrize("kind", ["box", "cup", "ball"])
def test_keeps_one_object_in_one_piece(scene: Any, solid: Any, kind: str) -> None:
    for turn in (0.0, 0.4, 0.8):
        assert len(detect(scene.image([solid(kind, 0.25, 0.05, turn=turn)]), scene.empty(), SETTINGS)) == 1


def test_specks_and_walls_are_no_objects(scene: Any) -> None:
    image = scene.empty().copy()
    image[50:55, 50:55] = 0
    assert detect(image, scene.empty(), SETTINGS) == ()
    image[:, 150:] = (255, 0, 0)
    assert detect(image, scene.empty(), SETTINGS) == ()


def test_images_must_match(scene: Any) -> None:
    with pytest.raises(ValueError, match=r"expected two alike \(H, W, 3\)"):
        detect(scene.empty()[:-1], scene.empty(), SETTINGS)


def test_crop_is_centred_and_scaled(scene: Any, solid: Any) -> None:
    (found,) = detect(scene.image([solid("ball", 0.25, 0.1)]), scene.empty(), SETTINGS)
    part, mask = crop(scene.image([solid("ball", 0.25, 0.1)]), found, margin=0.1)
    assert part.shape == (CROP_SIZE, CROP_SIZE, 3)
    rows, columns = np.nonzero(mask)
    assert abs(rows.mean() - 31.5) < 1.5
    assert abs(columns.mean() - 31.5) < 1.5
    assert 64 / 1.2 - 3 < max(np.ptp(rows), np.ptp(columns)) + 1 < 64 / 1.2 + 3
    assert part[mask][:, 0].mean() > 2 * part[mask][:, 1].mean()  # red inside
    assert part[0, 0].min() > 200  # table in the corner


def test_crop_at_the_edge_of_the_image_repeats_its_pixels() -> None:
    image = np.full((40, 50, 3), 200, dtype=np.uint8)
    mask = np.zeros((40, 50), dtype=bool)
    mask[30:40, :10] = True
    part, inside = crop(image, Found(mask, (0, 30, 10, 40)), margin=0.5)
    assert (part == 200).all()
    assert abs(inside.mean() - 0.25) < 0.03


def test_the_rim_does_not_count_unless_it_is_all() -> None:
    mask = np.zeros((20, 20), dtype=bool)
    mask[5:15, 5:15] = True
    found = Found(mask, (5, 5, 15, 15))
    inner = without_rim(found, 1)
    assert inner.mask[6:14, 6:14].all()
    assert inner.mask.sum() == 64
    assert inner.box == found.box
    assert (without_rim(found, 0).mask == mask).all()
    assert (without_rim(found, 9).mask == mask).all()


def test_marks_are_found_in_order(scene: Any) -> None:
    expected = scene.on_table(scene.marks)
    np.testing.assert_allclose(find_marks(scene.marked(), 5, 6), expected, atol=0.2)
    for turned in (np.rot90(scene.marked(), 2), np.fliplr(scene.marked())):  # far is up and left is left, always
        grid = find_marks(np.ascontiguousarray(turned), 5, 6).reshape(5, 6, 2)
        assert (np.diff(grid[:, :, 1].mean(axis=1)) > 0).all()
        assert (np.diff(grid[:, :, 0].mean(axis=0)) > 0).all()
    with pytest.raises(CalibrationError, match="does not show 5 × 6 dark dots"):
        find_marks(scene.empty(), 5, 6)


def test_homography_maps_pixels_to_the_table_and_the_camera_sees_heights(scene: Any, camera: Any) -> None:
    points = np.array([[0.2, 0.1], [0.4, -0.15], [0.3, 0.0]])
    np.testing.assert_allclose(to_table(camera, scene.on_table(points)), points, atol=1e-6)
    raised = np.column_stack([points, [0.0, 0.05, 0.1]])
    np.testing.assert_allclose(to_pixels(camera, raised), scene.project(raised), atol=1e-3)


def test_lens_distortion_is_undone(scene: Any) -> None:
    distortion = np.array([-0.2, 0.05, 0.0, 0.0, 0.0])
    ideal = scene.on_table(scene.marks)
    rays = np.column_stack([ideal, np.ones(len(ideal))]) @ np.linalg.inv(scene.matrix).T
    bent = cv2.projectPoints(rays, np.zeros(3), np.zeros(3), scene.matrix, distortion)[0].reshape(-1, 2)
    camera = fit_camera(bent, scene.marks, scene.matrix, distortion)
    np.testing.assert_allclose(to_table(camera, bent), scene.marks, atol=1e-4)


@pytest.mark.parametrize("distortion", [(0.1, -0.02, 0.003, 0.0), (0.0, 0.0, 0.0, 0.0)])
def test_a_fisheye_lens_is_undone(scene: Any, distortion: tuple[float, ...]) -> None:
    """Also where all coefficients are 0: a ray's distance from the centre still grows with its angle."""
    D = np.array(distortion)
    flat = np.column_stack([scene.on_table(scene.marks), np.ones(len(scene.marks))])
    rays = (flat @ np.linalg.inv(scene.matrix).T)[:, None]
    bent = cv2.fisheye.projectPoints(rays, np.zeros(3), np.zeros(3), scene.matrix, D)[0].reshape(-1, 2)
    camera = fit_camera(bent, scene.marks, scene.matrix, D, "equidistant")
    np.testing.assert_allclose(to_table(camera, bent), scene.marks, atol=1e-5)
    plain = fit_camera(bent, scene.marks, scene.matrix, D)
    assert np.abs(to_table(plain, bent) - scene.marks).max() > 1e-3


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda pixels, marks: (pixels[:3], marks[:3]), "3 marks seen of 3"),
        (lambda pixels, marks: (pixels[:-1], marks), "29 marks seen of 30"),
        (lambda pixels, marks: (pixels[:6], marks[:6]), "on a line"),
        (lambda pixels, marks: (pixels[::-1] + pixels[:, :1] * [0, 0.3], marks), "off the fit|from below"),
        (lambda pixels, marks: (pixels, marks * [1, -1]), "from below"),
    ],
)
def test_bad_calibrations_are_refused(scene: Any, change: Any, message: str) -> None:
    pixels, marks = change(scene.on_table(scene.marks), scene.marks)
    with pytest.raises(CalibrationError, match=message):
        fit_camera(pixels, marks, scene.matrix, NO_DISTORTION)


@pytest.mark.parametrize("kind", ["box", "cup", "ball"])
def test_position_of_what_rises_above_the_table(scene: Any, solid: Any, camera: Any, kind: str) -> None:
    random = np.random.default_rng(3)
    errors = []
    for _ in range(12):
        x, y = random.uniform([0.18, -0.18], [0.40, 0.18])
        one = solid(kind, x, y, turn=random.uniform(0, np.pi / 2))
        (found,) = detect(scene.image([one], shadow=0.7, noise=1.0), scene.empty(), SETTINGS)
        errors.append(np.linalg.norm(standing_position(found.mask, camera) - [x, y]))
    assert np.median(errors) < 0.004
    assert max(errors) < 0.015


def test_position_of_an_empty_mask_is_refused(camera: Any) -> None:
    with pytest.raises(ValueError, match="empty"):
        standing_position(np.zeros((240, 320), dtype=bool), camera)
