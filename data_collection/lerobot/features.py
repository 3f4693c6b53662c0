"""The features of a dataset: their names, sizes and types, as its files describe them.

`observation.state` are the 25 joint positions, `action` those of the next frame, `observation.tactile` the nine
touch values.
"""

from typing import Any

from data_collection.joints import JOINT_NAMES, TACTILE_NAMES

IMAGE_KEY = "observation.images.left_eye"
VECTORS = {
    "observation.state": JOINT_NAMES,
    "observation.tactile": TACTILE_NAMES,
    "observation.hand_position": ("x", "y", "z"),
    "action": JOINT_NAMES,
}
"""Feature → names of its numbers."""
SCALARS = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
"""Feature of one number → its type."""


def huggingface_features() -> dict[str, Any]:
    """Return the features as the datasets library keeps them in the metadata of a Parquet file."""
    features: dict[str, Any] = {
        key: {"feature": {"dtype": "float32", "_type": "Value"}, "length": len(names), "_type": "Sequence"}
        for key, names in VECTORS.items()
    }
    features[IMAGE_KEY] = {"_type": "Image"}
    return features | {key: {"dtype": dtype, "_type": "Value"} for key, dtype in SCALARS.items()}


def features(size: tuple[int, ...]) -> dict[str, Any]:
    """Return the features as `info.json` lists them, for images of `size` (height, width, 3)."""
    features: dict[str, Any] = {
        key: {"dtype": "float32", "shape": [len(names)], "names": list(names)} for key, names in VECTORS.items()
    }
    features[IMAGE_KEY] = {"dtype": "image", "shape": list(size), "names": ["height", "width", "channels"]}
    return features | {key: {"dtype": dtype, "shape": [1], "names": None} for key, dtype in SCALARS.items()}
