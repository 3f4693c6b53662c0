"""Write logs as a dataset: all of it, or nothing."""

import json
import shutil
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from data_collection.lerobot.episodes import episodes, rate_of
from data_collection.lerobot.features import features
from data_collection.lerobot.statistics import Statistics
from data_collection.lerobot.tables import episode_row, frames_table, write_episodes, write_tasks
from data_collection.log.mcap_log import LogError


def export(logs: Sequence[Path], folder: Path) -> list[str]:
    """Write the trials of `logs` as a LeRobot dataset; the folder appears only when it is complete.

    Args:
        logs: Logs of trials; calibration logs and instructions without an action are passed over.
        folder: New folder.

    Returns:
        What of the logs is left out, or not as the dataset says.

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
        notes = _write(part, logs)
        part.chmod(0o755)
        part.rename(folder)
        return notes
    except BaseException:
        shutil.rmtree(part, ignore_errors=True)
        raise


def _write(folder: Path, logs: Sequence[Path]) -> list[str]:
    import pyarrow.parquet as parquet

    tasks: dict[str, int] = {}
    rows: list[dict[str, Any]] = []
    notes: list[str] = []
    statistics = Statistics()
    start, size, rate = 0, None, 0.0
    path = folder / "data/chunk-000/file-000.parquet"
    path.parent.mkdir(parents=True)
    writer = None
    with ExitStack() as stack:
        for episode in episodes(logs):
            shape = episode.pictures[0].shape
            if size is not None and shape != size:
                raise LogError(f"{episode.source} has images of {shape}, the trials before it of {size}")
            own_rate = rate_of(episode)
            if size is None:
                size, rate = shape, own_rate
            if abs(own_rate - rate) > 0.1 * rate:
                says = f"has {own_rate:g} joint states a second, the first trial {rate:g}"
                raise LogError(f"{episode.source} {says}")
            task = tasks.setdefault(episode.task, len(tasks))
            table = frames_table(episode, len(rows), start, task, rate)
            writer = writer or stack.enter_context(parquet.ParquetWriter(path, table.schema, compression="zstd"))
            writer.write_table(table)
            found = statistics.add(episode, table)
            count = table.num_rows
            rows.append(episode_row(len(rows), episode.task, start, count, found))
            notes += episode.notes
            start += count
    if size is None:
        raise LogError("none of the logs holds a trial")
    write_episodes(folder / "meta/episodes/chunk-000/file-000.parquet", rows)
    write_tasks(folder / "meta/tasks.parquet", tasks)
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
        "features": features(size),
    }
    (folder / "meta/info.json").write_text(json.dumps(info, indent=2))
    (folder / "meta/stats.json").write_text(json.dumps(statistics.result(), indent=2))
    return notes
