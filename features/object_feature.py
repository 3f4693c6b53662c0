"""Object feature: 4096 numbers of AlexNet's first fully connected layer, fc6 (paper, section 4.2.1).

The only module that imports torch, and only when the network runs.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from data_collection.seeding import generator
from features.detection import Image, Mask
from features.extraction_settings import FeatureSettings

FC6_SIZE = 4096
_INPUT_SIZE = 224
_BATCH = 8
_IMAGENET_MEAN = np.array([0.485, 0.456, 0.406], dtype=np.float32)
_IMAGENET_STD = np.array([0.229, 0.224, 0.225], dtype=np.float32)
_LUMINANCE = np.array([0.299, 0.587, 0.114], dtype=np.float32)  # ITU-R BT.601
_FLAT = 1e-3  # contrast below which a crop is flat
_BRIGHTEST = 3.0  # limit of normalised luminance: a glint does not outweigh the shape


class WeightsError(RuntimeError):
    """The network's weights cannot be loaded or do not fit; the message says which and why."""


def network_input(crops: Image, masks: Mask, appearance: str) -> NDArray[np.float32]:
    """Turn crops into the network's input.

    Args:
        crops: uint8 (N, 64, 64, 3) RGB.
        masks: bool (N, 64, 64).
        appearance: `luminance`: brightness with mean 0 and standard deviation 1 inside the mask, 0 outside,
            so that neither color nor light nor table tells objects apart; `rgb`: the crop as it is, in
            ImageNet's normalisation.

    Returns:
        float32 (N, 3, 64, 64).
    """
    values = crops.astype(np.float32) / 255
    if appearance == "rgb":
        return np.ascontiguousarray(np.moveaxis((values - _IMAGENET_MEAN) / _IMAGENET_STD, -1, 1))
    luminance = np.where(masks, values @ _LUMINANCE, 0)
    area = np.maximum(masks.sum(axis=(1, 2), keepdims=True), 1)
    centred = np.where(masks, luminance - luminance.sum(axis=(1, 2), keepdims=True) / area, 0)
    contrast = np.sqrt((centred**2).sum(axis=(1, 2), keepdims=True) / area)
    normalised = np.clip(centred / np.maximum(contrast, _FLAT), -_BRIGHTEST, _BRIGHTEST).astype(np.float32)
    return np.ascontiguousarray(np.broadcast_to(normalised[:, None], (len(crops), 3, *crops.shape[1:3])))


def fc6(crops: Image, masks: Mask, settings: FeatureSettings) -> NDArray[np.float32]:
    """Run the network on N crops.

    Args:
        crops: uint8 (N, 64, 64, 3) RGB.
        masks: bool (N, 64, 64), none of them empty.
        settings: Weights and appearance.

    Returns:
        float32 (N, 4096), after the rectification, so 0 or more.

    Raises:
        WeightsError: The weights cannot be loaded.
        ValueError: A mask is empty.
    """
    if empty := np.flatnonzero(~masks.any(axis=(1, 2))).tolist():
        raise ValueError(f"the masks of crops {empty} are empty; expected objects in all")
    if len(crops) == 0:
        return np.zeros((0, FC6_SIZE), dtype=np.float32)
    import torch

    images = network_input(crops, masks, settings.appearance)
    threads = torch.get_num_threads()
    torch.set_num_threads(1)  # the order of the sums, and so their last bits, would depend on the number
    try:
        network = _network(settings.weights, settings.weights_seed)
        with torch.inference_mode():
            rows = [_run(network, images[i : i + _BATCH]) for i in range(0, len(images), _BATCH)]
    finally:
        torch.set_num_threads(threads)
    return np.concatenate(rows)


def _run(network: Any, images: NDArray[np.float32]) -> NDArray[np.float32]:
    """Run one batch, filled up to its full size: the last bits of an image's numbers may depend on the size."""
    import torch

    batch = np.zeros((_BATCH, *images.shape[1:]), dtype=np.float32)
    batch[: len(images)] = images
    size = (_INPUT_SIZE, _INPUT_SIZE)
    enlarged = torch.nn.functional.interpolate(torch.from_numpy(batch), size, mode="bilinear", antialias=False)
    return np.asarray(network(enlarged).numpy()[: len(images)], dtype=np.float32)


def weights_problem(weights: str) -> str:
    """Say why weights cannot be used, with the file's name; empty if they can."""
    try:
        _network(weights, 0)
    except WeightsError as error:
        return str(error)
    return ""


@cache
def _network(weights: str, seed: int) -> Any:
    """Return AlexNet up to fc6, rectified, with its weights."""
    import torch

    with torch.device("meta"):  # shapes only: the weights come from elsewhere
        alexnet = _torchvision_models().alexnet()
    network = torch.nn.Sequential(
        alexnet.features, alexnet.avgpool, torch.nn.Flatten(), alexnet.classifier[1], torch.nn.ReLU()
    )
    names = {f"{part}.{name}" for part, module in (("features", network[0]), ("classifier.1", network[3]))
             for name in module.state_dict()}  # fmt: skip
    shapes = {name: tuple(value.shape) for name, value in alexnet.state_dict().items() if name in names}
    state = _seeded(shapes, seed) if weights == "seeded" else _loaded(weights, shapes)
    for prefix, module in (("features.", network[0]), ("classifier.1.", network[3])):
        own = {name.removeprefix(prefix): value for name, value in state.items() if name.startswith(prefix)}
        module.load_state_dict(own, assign=True)
    return network.eval()


def _torchvision_models() -> Any:
    """Import torchvision's models, even where its compiled operators do not load.

    A torchvision built for CUDA finds no CUDA libraries beside a CPU-only torch, its operators stay unknown,
    and `import torchvision` fails as it registers their shape rules. AlexNet uses none of them. So where (and
    only where) the operators do not load, the two that the import needs are declared, without a body.
    """
    import importlib.util

    import torch

    specification = importlib.util.find_spec("torchvision")
    folders = list((specification and specification.submodule_search_locations) or [])
    compiled = sorted(file for folder in folders for file in Path(folder).glob("_C.*"))
    try:
        for file in compiled:
            torch.ops.load_library(file)
    except OSError:
        compiled = []
    if not compiled and not hasattr(torch.ops.torchvision, "nms"):
        _torchvision_models.library = torch.library.Library("torchvision", "DEF")  # type: ignore[attr-defined]
        for name in ("nms", "qnms"):
            _torchvision_models.library.define(  # type: ignore[attr-defined]
                f"{name}(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"
            )
    from torchvision import models

    return models


def _seeded(shapes: Mapping[str, tuple[int, ...]], seed: int) -> dict[str, Any]:
    """Draw weights by He et al. 2015 (normal, variance 2 / inputs), biases zero; the same on every machine."""
    import torch

    state = {}
    for name, shape in shapes.items():
        values = np.zeros(shape, dtype=np.float32)
        if name.endswith("weight"):
            generator(seed, "alexnet", name).standard_normal(dtype=np.float32, out=values)
            values *= np.float32(np.sqrt(2 / np.prod(shape[1:])))
        state[name] = torch.from_numpy(values)
    return state


def _loaded(weights: str, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, Any]:
    """Load published weights, or those of a file, and check their names and shapes."""
    import torch

    try:
        if weights == "imagenet1k":
            state = _torchvision_models().AlexNet_Weights.IMAGENET1K_V1.get_state_dict(
                progress=False, check_hash=True
            )
        else:
            state = torch.load(weights, map_location="cpu", weights_only=True)
    except FileNotFoundError as error:
        raise WeightsError(f"{weights}: no such file of weights") from error
    except Exception as error:  # damaged bytes surface as pickle, zip, memory, attribute, … errors
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        hint = "; it needs the network once, or use `weights: seeded`" if weights == "imagenet1k" else ""
        raise WeightsError(f"weights {weights} cannot be loaded: {reason}{hint}") from error
    problems = [f"{name} is {_shape(state, name)}; expected {shape}"
                for name, shape in shapes.items() if _shape(state, name) != shape]  # fmt: skip
    if problems:
        raise WeightsError(f"{weights}: not the weights of torchvision's AlexNet: " + "; ".join(problems))
    weights_ = {name: state[name].to(torch.float32) for name in shapes}
    if unusable := [name for name, value in weights_.items() if value.is_meta or not value.isfinite().all()]:
        raise WeightsError(f"{weights}: {', '.join(unusable)} hold no finite numbers")
    return weights_


def _shape(state: Any, name: str) -> tuple[int, ...] | None:
    """Return the shape of one tensor of a state dict; None without it."""
    import torch

    value = state.get(name) if isinstance(state, Mapping) else None
    if not (isinstance(value, torch.Tensor) and value.is_floating_point() and value.layout == torch.strided):
        return None
    return tuple(value.shape)


def weights_provenance(settings: FeatureSettings) -> str:
    """Name the weights: how they were made, or the SHA-256 of their file."""
    if settings.weights == "seeded":
        return f"seeded {settings.weights_seed}"
    if settings.weights == "imagenet1k":
        return "torchvision AlexNet_Weights.IMAGENET1K_V1"
    try:
        with Path(settings.weights).open("rb") as file:
            return f"sha256 {hashlib.file_digest(file, 'sha256').hexdigest()}"
    except OSError as error:
        raise WeightsError(f"{settings.weights}: weights cannot be read ({error.strerror})") from error
