"""AlexNet's fc6: appearance, weights, determinism, and where torch is imported."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from features import object_feature
from features.extraction_settings import FeatureSettings
from features.object_feature import WeightsError, fc6, network_input, weights_provenance

SEEDED = FeatureSettings()


@pytest.fixture(scope="module")
def crops() -> tuple[np.ndarray, np.ndarray]:
    """Five crops: a disc, the same in other light and color, a square, a triangle, a bar."""
    y, x = np.mgrid[:64, :64] - 31.5
    masks = np.stack([x**2 + y**2 < 600, x**2 + y**2 < 600, (abs(x) < 22) & (abs(y) < 22), abs(x) < y / 2 + 12,
                      abs(y) < 8])  # fmt: skip
    shade = 1 + 0.01 * x[None] - 0.006 * y[None]
    colors = np.array([[180, 40, 40], [90, 20, 20], [40, 160, 40], [40, 40, 200], [180, 40, 40]])
    images = np.where(masks[..., None], shade[..., None] * colors[:, None, None], 240)
    return np.clip(np.rint(images), 0, 255).astype(np.uint8), masks


def test_luminance_is_normalised_inside_and_flat_outside(crops: tuple[np.ndarray, np.ndarray]) -> None:
    images, masks = crops
    values = network_input(images, masks, "luminance")
    assert values.shape == (5, 3, 64, 64)
    for value, mask in zip(values, masks, strict=True):
        assert np.abs(value[:, ~mask]).max() == 0
        np.testing.assert_allclose(value[:, mask].mean(axis=1), 0, atol=1e-4)
        np.testing.assert_allclose(value[:, mask].std(axis=1), 1, atol=1e-4)
    # the disc at half the light looks the same, and what is on the table around it does not show
    assert np.abs(values[0] - values[1]).max() < 0.1
    cluttered = images.copy()
    cluttered[~masks] = 0
    np.testing.assert_array_equal(network_input(cluttered, masks, "luminance"), values)


def test_an_object_without_contrast_is_flat_and_finite() -> None:
    flat = np.full((1, 64, 64, 3), 100, dtype=np.uint8)
    values = network_input(flat, np.ones((1, 64, 64), dtype=bool), "luminance")
    assert np.abs(values).max() < 0.1


def test_rgb_is_imagenets_normalisation() -> None:
    image = np.full((1, 64, 64, 3), 255, dtype=np.uint8)
    values = network_input(image, np.ones((1, 64, 64), dtype=bool), "rgb")
    np.testing.assert_allclose(values[0, :, 0, 0], [(1 - 0.485) / 0.229, (1 - 0.456) / 0.224, (1 - 0.406) / 0.225])


def test_same_input_same_numbers_whatever_the_company(crops: tuple[np.ndarray, np.ndarray]) -> None:
    images, masks = crops
    whole = fc6(images, masks, SEEDED)
    assert whole.shape == (5, 4096)
    assert whole.dtype == np.float32
    assert np.isfinite(whole).all()
    np.testing.assert_array_equal(fc6(images[3:], masks[3:], SEEDED), whole[3:])
    many = fc6(np.repeat(images, 4, axis=0), np.repeat(masks, 4, axis=0), SEEDED)
    np.testing.assert_array_equal(many[::4], whole)
    distance = np.linalg.norm(whole - whole[0], axis=1)
    assert distance[1] < 0.2 * distance[2:].min()  # a shape in other light is nearer than any other shape


def test_the_number_of_threads_does_not_show(crops: tuple[np.ndarray, np.ndarray]) -> None:
    import torch

    before = torch.get_num_threads()
    results = []
    for threads in (1, 2):
        torch.set_num_threads(threads)
        results.append(fc6(*crops, SEEDED))
        assert torch.get_num_threads() == threads
    torch.set_num_threads(before)
    np.testing.assert_array_equal(*results)


def test_weights_follow_their_seed(crops: tuple[np.ndarray, np.ndarray]) -> None:
    images, masks = crops
    other = FeatureSettings.model_validate({"weights_seed": 1})
    assert not np.array_equal(fc6(images, masks, other), fc6(images, masks, SEEDED))


def test_no_objects_and_empty_masks() -> None:
    none = np.zeros((0, 64, 64, 3), dtype=np.uint8), np.zeros((0, 64, 64), dtype=bool)
    assert fc6(*none, SEEDED).shape == (0, 4096)
    masks = np.stack([np.ones((64, 64), dtype=bool), np.zeros((64, 64), dtype=bool)])
    with pytest.raises(ValueError, match=r"masks of crops \[1\] are empty"):
        fc6(np.zeros((2, 64, 64, 3), dtype=np.uint8), masks, SEEDED)


def state() -> dict[str, object]:
    import torch

    shapes = {
        "features.0.weight": (64, 3, 11, 11), "features.0.bias": (64,),
        "features.3.weight": (192, 64, 5, 5), "features.3.bias": (192,),
        "features.6.weight": (384, 192, 3, 3), "features.6.bias": (384,),
        "features.8.weight": (256, 384, 3, 3), "features.8.bias": (256,),
        "features.10.weight": (256, 256, 3, 3), "features.10.bias": (256,),
        "classifier.1.weight": (4096, 9216), "classifier.1.bias": (4096,),
    }  # fmt: skip
    return {name: torch.full(shape, 0.001) for name, shape in shapes.items()}


def test_weights_of_a_file(tmp_path: Path, crops: tuple[np.ndarray, np.ndarray]) -> None:
    import torch

    path = tmp_path / "weights.pt"
    torch.save(state(), path)
    settings = FeatureSettings.model_validate({"weights": str(path), "appearance": "rgb"})
    values = fc6(*crops, settings)
    assert np.ptp(values, axis=1).max() == 0  # all weights alike, so all units
    assert values.max() > 0
    assert weights_provenance(settings).startswith("sha256 ")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("shape", r"classifier\.1\.weight is \(10, 10\); expected \(4096, 9216\)"),
        ("lacking", r"features\.3\.bias is None; expected \(192,\)"),
        ("list", "not the weights of torchvision's AlexNet"),
        ("text", "cannot be loaded"),
        ("pickle", "cannot be loaded"),
        ("missing", "no such file"),
    ],
)
def test_unfit_weights_are_refused(
    tmp_path: Path, crops: tuple[np.ndarray, np.ndarray], change: str, message: str
) -> None:
    import torch

    path, values = tmp_path / "weights.pt", state()
    if change == "shape":
        torch.save(values | {"classifier.1.weight": torch.zeros(10, 10)}, path)
    elif change == "lacking":
        del values["features.3.bias"]
        torch.save(values, path)
    elif change == "list":
        torch.save([1, 2], path)
    elif change == "text":
        path.write_text("not weights", encoding="utf-8")
    elif change == "pickle":
        torch.save(Path("/"), path)  # an object that a state dict has no use for
    with pytest.raises(WeightsError, match=message):
        fc6(*crops, FeatureSettings.model_validate({"weights": str(path)}))


def test_published_weights_offline_say_what_to_do(
    crops: tuple[np.ndarray, np.ndarray], monkeypatch: pytest.MonkeyPatch
) -> None:
    import urllib.error

    def offline(*arguments: object, **keywords: object) -> None:
        raise urllib.error.URLError("no route to host")

    loader = object_feature._torchvision_models().AlexNet_Weights.__mro__[1].__module__
    monkeypatch.setattr(sys.modules[loader], "load_state_dict_from_url", offline)
    with pytest.raises(WeightsError, match=r"weights imagenet1k cannot be loaded.*no route.*weights: seeded"):
        fc6(*crops, FeatureSettings.model_validate({"weights": "imagenet1k"}))


def test_heavy_packages_are_imported_only_where_they_are_used() -> None:
    modules = sorted(path.stem for path in Path(object_feature.__file__).parent.glob("[a-z]*.py"))
    heavy = {"torch", "torchvision", "cv2", "sklearn", "matplotlib", "pybullet"}
    imports = "; ".join(f"import features.{name}" for name in modules)
    code = f"import sys; {imports}; print(*({heavy} & set(sys.modules)))"
    folder = Path(object_feature.__file__).parents[1]
    run = subprocess.run([sys.executable, "-c", code], check=True, cwd=folder, capture_output=True, text=True)
    assert run.stdout.split() == []
