"""Export of logs to a LeRobot v3.0 dataset, written with pyarrow alone.

One trial is one episode, one joint message one frame. ``observation.state`` are the 25 joint positions, ``action``
those of the next frame, ``observation.tactile`` the nine touch values, the image is the latest one taken (before, at
gaze, after), and the task is the tutor's sentence.
"""

import json
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.joints import JOINT_NAMES, TACTILE_NAMES
from data_collection.log import channels, codec
from data_collection.log.mcap_log import Log, LogError, read_log
from data_collection.log.messages import Floats, Image, JointState
from data_collection.log.trial import observation
from data_collection.log.validation import kind_of

IMAGE_KEY = "observation.images.left_eye"
_VECTORS = {
    "observation.state": JOINT_NAMES,
    "observation.tactile": TACTILE_NAMES,
    "observation.hand_position": ("x", "y", "z"),
    "action": JOINT_NAMES,
}
_SCALARS = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
_IMAGES = (channels.IMAGE_BEFORE, channels.IMAGE_GAZE, channels.IMAGE_AFTER)


@dataclass(frozen=True)
class _Episode:
    """Arrays of one trial: each vector (F, n), the encoded pictures, and for each of F frames which one it shows."""

    task: str
    times: Floats
    vectors: dict[str, Floats]
    pictures: tuple[Image, ...]
    shown: tuple[int, ...]


def export(logs: Sequence[Path], folder: Path) -> None:
    """Write the trials of ``logs`` as a LeRobot dataset; the folder appears only when it is complete.

    Args:
        logs: Logs of trials; calibration logs and instructions without an action are passed over.
        folder: New folder.

    Raises:
        LogError: A log is damaged or invalid, or none holds a trial, or they differ in size of images
            or in rate.
        FileExistsError: The folder is there already.
    """
    if folder.exists():
        raise FileExistsError(f"{folder} is there already")
    folder.parent.mkdir(parents=True, exist_ok=True)
    part = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", suffix=".part", dir=folder.parent))
    try:
        _write(part, logs)
        part.chmod(0o755)
        part.rename(folder)
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise


def _write(folder: Path, logs: Sequence[Path]) -> None:
    import pyarrow.parquet as parquet

    tasks: dict[str, int] = {}
    rows: list[dict[str, Any]] = []
    statistics = _Statistics()
    start, size, rate = 0, None, 0.0
    path = folder / "data/chunk-000/file-000.parquet"
    path.parent.mkdir(parents=True)
    writer = None
    try:
        for episode in _episodes(logs):
            shape = episode.pictures[0].shape
            if size is not None and shape != size:
                raise LogError(f"trial {len(rows)} of the export has images of {shape}, the first one of {size}")
            own_rate = _rate(episode.times)
            if size is None:
                size, rate = shape, own_rate
            if abs(own_rate - rate) > 0.1 * rate:
                says = f"has {own_rate:g} joint states a second, the first one {rate:g}"
                raise LogError(f"trial {len(rows)} of the export {says}")
            task = tasks.setdefault(episode.task, len(tasks))
            table = _table(episode, len(rows), start, task, rate)
            writer = writer or parquet.ParquetWriter(path, table.schema, compression="zstd")
            writer.write_table(table)
            statistics.add(episode, table)
            count = table.num_rows
            rows.append(_row(len(rows), episode.task, start, count))
            start += count
    finally:
        if writer is not None:
            writer.close()
    if size is None:
        raise LogError("none of the logs holds a trial")
    _write_episodes(folder / "meta/episodes/chunk-000/file-000.parquet", rows)
    _write_tasks(folder / "meta/tasks.parquet", tasks)
    info = {
        "codebase_version": "v3.0",
        "robot_type": "icub",
        "total_episodes": len(rows),
        "total_frames": start,
        "total_tasks": len(tasks),
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 500,
        "fps": round(rate),
        "splits": {"train": f"0:{len(rows)}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "features": _features(size),
    }
    (folder / "meta/info.json").write_text(json.dumps(info, indent=2))
    (folder / "meta/stats.json").write_text(json.dumps(statistics.result(), indent=2))


def _episodes(logs: Sequence[Path]) -> Iterator[_Episode]:
    for path in logs:
        log = read_log(path)
        if kind_of(log) == "trial":
            yield _episode(log)


def _episode(log: Log) -> _Episode:
    seen = observation(log)
    latest: dict[str, Any] = {}
    pictures: list[Image] = []
    frames: list[tuple[int, Floats, Floats, Floats, int]] = []
    for time in sorted({message.time for message in log.messages}):
        for message in (message for message in log.messages if message.time == time):
            latest[message.topic] = message.value
            if message.topic in _IMAGES:
                pictures.append(np.asarray(message.value, dtype=np.uint8))
        state = latest.get(channels.JOINT_STATES)
        fresh = any(message.time == time and message.topic == channels.JOINT_STATES for message in log.messages)
        if (
            fresh
            and isinstance(state, JointState)
            and pictures
            and {channels.TACTILE, channels.HAND_POSE} <= set(latest)
        ):
            frames.append(
                (time, state.position, latest[channels.TACTILE], latest[channels.HAND_POSE][:3], len(pictures) - 1)
            )
    if not frames:
        raise LogError(f"{log.source}: no joint state after the first image with touch and hand pose")
    states = np.array([frame[1] for frame in frames])
    vectors = {
        "observation.state": states,
        "observation.tactile": np.array([frame[2] for frame in frames]),
        "observation.hand_position": np.array([frame[3] for frame in frames]),
        "action": np.vstack([states[1:], states[-1:]]),
    }
    times = (np.array([frame[0] for frame in frames], dtype=np.float64) - frames[0][0]) / codec.NANOSECONDS
    return _Episode(" ".join(seen.words), times, vectors, tuple(pictures), tuple(frame[4] for frame in frames))


def _rate(times: Floats) -> float:
    return float(max(1, round(1.0 / np.median(np.diff(times))))) if len(times) > 1 else 1.0


def _table(episode: _Episode, number: int, start: int, task: int, rate: float) -> Any:
    import pyarrow as pa

    count = len(episode.times)
    columns: dict[str, Any] = {}
    for key, names in _VECTORS.items():
        values = pa.array(episode.vectors[key].astype(np.float32).ravel())
        columns[key] = pa.FixedSizeListArray.from_arrays(values, len(names))
    encoded = [codec.encode_png(picture) for picture in episode.pictures]
    picture_type = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
    columns[IMAGE_KEY] = pa.array([{"bytes": encoded[index], "path": None} for index in episode.shown], picture_type)
    # LeRobot wants timestamps at the exact rate: frame / fps. The last frame of an action comes a little early.
    columns["timestamp"] = pa.array((np.arange(count) / rate).astype(np.float32))
    columns["frame_index"] = pa.array(np.arange(count))
    columns["episode_index"] = pa.array(np.full(count, number))
    columns["index"] = pa.array(np.arange(start, start + count))
    columns["task_index"] = pa.array(np.full(count, task))
    table = pa.table(columns)
    return table.replace_schema_metadata({"huggingface": json.dumps({"info": {"features": _huggingface()}})})


def _huggingface() -> dict[str, Any]:
    features: dict[str, Any] = {
        key: {"feature": {"dtype": "float32", "_type": "Value"}, "length": len(names), "_type": "Sequence"}
        for key, names in _VECTORS.items()
    }
    features[IMAGE_KEY] = {"_type": "Image"}
    return features | {key: {"dtype": dtype, "_type": "Value"} for key, dtype in _SCALARS.items()}


def _features(size: tuple[int, ...]) -> dict[str, Any]:
    features: dict[str, Any] = {
        key: {"dtype": "float32", "shape": [len(names)], "names": list(names)} for key, names in _VECTORS.items()
    }
    features[IMAGE_KEY] = {"dtype": "image", "shape": list(size), "names": ["height", "width", "channels"]}
    return features | {key: {"dtype": dtype, "shape": [1], "names": None} for key, dtype in _SCALARS.items()}


def _row(number: int, task: str, start: int, count: int) -> dict[str, Any]:
    return {
        "episode_index": number,
        "tasks": [task],
        "length": count,
        "dataset_from_index": start,
        "dataset_to_index": start + count,
        "data/chunk_index": 0,
        "data/file_index": 0,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }


def _write_episodes(path: Path, rows: list[dict[str, Any]]) -> None:
    import pyarrow as pa
    import pyarrow.parquet as parquet

    path.parent.mkdir(parents=True)
    parquet.write_table(pa.Table.from_pylist(rows), path)


def _write_tasks(path: Path, tasks: dict[str, int]) -> None:
    """Write the tasks as LeRobot reads them: a pandas frame whose index is the sentence."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    index = "__index_level_0__"
    described = [
        {"name": name, "field_name": field, "pandas_type": kind, "numpy_type": stored, "metadata": None}
        for name, field, kind, stored in (
            ("task_index", "task_index", "int64", "int64"),
            (None, index, "unicode", "object"),
        )
    ]
    pandas = {"index_columns": [index], "column_indexes": [], "columns": described}
    table = pa.table({"task_index": pa.array(list(tasks.values()), pa.int64()), index: list(tasks)})
    parquet.write_table(table.replace_schema_metadata({"pandas": json.dumps(pandas)}), path)


class _Statistics:
    """Minimum, maximum, mean and standard deviation of every feature, one episode at a time."""

    def __init__(self) -> None:
        self._parts: dict[str, list[tuple[Floats, Floats, Floats, Floats, int]]] = {}

    def add(self, episode: _Episode, table: Any) -> None:
        """Take in an episode and its table."""
        for key, values in episode.vectors.items():
            self._append(key, values)
        for key in _SCALARS:
            self._append(key, np.asarray(table[key].to_numpy(), dtype=np.float64)[:, None])
        pixels = np.concatenate([episode.pictures[index].reshape(-1, 3) for index in sorted(set(episode.shown))])
        self._append(IMAGE_KEY, pixels / 255.0)

    def result(self) -> dict[str, dict[str, Any]]:
        """Return the statistics in the form of ``stats.json``; those of images have shape (3, 1, 1)."""
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
