"""The Parquet files of a dataset: frames, episodes and tasks."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from data_collection.lerobot.episodes import Episode
from data_collection.lerobot.features import IMAGE_KEY, VECTORS, huggingface_features
from data_collection.lerobot.statistics import Found
from data_collection.log import codec


def frames_table(episode: Episode, number: int, start: int, task: int, rate: float) -> Any:
    """Return the frames of an episode as a pyarrow table.

    Args:
        episode: The trial.
        number: Of the episode in the dataset.
        start: Number of frames before it.
        task: Number of its sentence.
        rate: Frames a second of the dataset.
    """
    import pyarrow as pa

    count = len(episode.times)
    columns: dict[str, Any] = {}
    for key, names in VECTORS.items():
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
    return table.replace_schema_metadata({"huggingface": json.dumps({"info": {"features": huggingface_features()}})})


def episode_row(number: int, task: str, start: int, count: int, statistics: Found) -> dict[str, Any]:
    """Return what the table of episodes says of one: its number, sentence, first frame, length and statistics."""
    told = {f"stats/{key}/{name}": value for key, own in statistics.items() for name, value in own.items()}
    return told | {
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


def write_episodes(path: Path, rows: list[dict[str, Any]]) -> None:
    """Write the table of episodes."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    path.parent.mkdir(parents=True)
    parquet.write_table(pa.Table.from_pylist(rows), path)


def write_tasks(path: Path, tasks: dict[str, int]) -> None:
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
