import dataclasses
import io
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow.parquet as parquet
import pytest
from PIL import Image

from data_collection.joints import JOINT_NAMES
from data_collection.lerobot.export import export
from data_collection.lerobot.features import IMAGE_KEY
from data_collection.log.mcap_log import Log, LogError, write_log
from data_collection.log.trial import observation


@pytest.fixture(scope="module")
def dataset(trials: list[Log], calibration_log: Log, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lerobot")
    for number, log in enumerate([*trials, calibration_log]):
        write_log(folder / "logs" / f"{number}.mcap", log)
    export(sorted((folder / "logs").iterdir()), folder / "out")
    return folder / "out"


def test_layout(dataset: Path) -> None:
    found = {str(path.relative_to(dataset)) for path in dataset.rglob("*") if path.is_file()}
    assert found == {
        "meta/info.json",
        "meta/stats.json",
        "meta/tasks.parquet",
        "meta/episodes/chunk-000/file-000.parquet",
        "data/chunk-000/file-000.parquet",
    }


def test_info_agrees_with_the_data(dataset: Path, trials: list[Log]) -> None:
    info = json.loads((dataset / "meta/info.json").read_text())
    table = parquet.read_table(dataset / "data/chunk-000/file-000.parquet")
    assert info["codebase_version"] == "v3.0"
    assert info["total_episodes"] == len(trials)
    assert info["total_frames"] == table.num_rows
    assert info["fps"] == 20
    assert set(info["features"]) == set(table.column_names)
    assert info["features"]["observation.state"]["names"] == list(JOINT_NAMES)
    described = json.loads(table.schema.metadata[b"huggingface"])["info"]["features"]
    assert set(described) == set(table.column_names)
    stats = json.loads((dataset / "meta/stats.json").read_text())
    assert set(stats) == set(table.column_names)
    states = np.array(table["observation.state"].to_pylist())
    assert stats["observation.state"]["mean"] == pytest.approx(states.mean(axis=0).tolist(), abs=1e-5)
    assert stats["observation.state"]["std"] == pytest.approx(states.std(axis=0).tolist(), abs=1e-5)
    assert np.shape(stats[IMAGE_KEY]["mean"]) == (3, 1, 1)


def test_episodes_and_tasks(dataset: Path, trials: list[Log]) -> None:
    episodes = pd.read_parquet(dataset / "meta/episodes/chunk-000/file-000.parquet")
    tasks = pd.read_parquet(dataset / "meta/tasks.parquet")
    table = parquet.read_table(dataset / "data/chunk-000/file-000.parquet").to_pandas()
    for number, log in enumerate(trials):
        row = episodes.iloc[number]
        sentence = " ".join(observation(log).words)
        frames = table.iloc[row["dataset_from_index"] : row["dataset_to_index"]]
        assert list(row["tasks"]) == [sentence]
        assert tasks.iloc[frames["task_index"].iloc[0]].name == sentence
        assert len(frames) == row["length"]
        assert set(frames["episode_index"]) == {number}
        assert list(frames["frame_index"]) == list(range(len(frames)))
        assert frames["timestamp"].to_numpy() == pytest.approx(np.arange(len(frames)) / 20)
    assert list(table["index"]) == list(range(len(table)))


def test_frames_hold_what_the_logs_hold(dataset: Path, trials: list[Log]) -> None:
    table = parquet.read_table(dataset / "data/chunk-000/file-000.parquet").to_pandas()
    first = table[table["episode_index"] == 0]
    seen = observation(trials[0])
    assert first["observation.state"].iloc[-1] == pytest.approx(seen.joint_positions.astype(np.float32))
    assert first["observation.tactile"].iloc[-1] == pytest.approx(seen.tactile.astype(np.float32))
    assert first["action"].iloc[0] == pytest.approx(first["observation.state"].iloc[1])
    for row, picture in ((0, seen.image_before), (-1, seen.image_after)):
        decoded = np.asarray(Image.open(io.BytesIO(first[IMAGE_KEY].iloc[row]["bytes"])))
        assert picture is not None
        assert np.array_equal(decoded, picture)


def test_the_library_datasets_loads_it(
    dataset: Path, trials: list[Log], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As LeRobot does; skipped where the library, on which nothing here depends, is not installed."""
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    datasets = pytest.importorskip("datasets")
    path = str(dataset / "data/chunk-000/file-000.parquet")
    loaded = datasets.Dataset.from_parquet(path, cache_dir=str(tmp_path))
    info = json.loads((dataset / "meta/info.json").read_text())
    assert len(loaded) == info["total_frames"]
    for key, feature in info["features"].items():
        kind = loaded.features[key]
        if feature["dtype"] == "image":
            assert type(kind).__name__ == "Image"
        else:
            assert getattr(kind, "length", 1) == feature["shape"][0]
            assert getattr(kind, "feature", kind).dtype == feature["dtype"]
    assert np.array_equal(np.asarray(loaded[0][IMAGE_KEY]), observation(trials[0]).image_before)


def test_refusals(dataset: Path, calibration_log: Log, tmp_path: Path) -> None:
    with pytest.raises(FileExistsError):
        export([], dataset)
    write_log(tmp_path / "c.mcap", calibration_log)
    with pytest.raises(LogError, match="none of the logs"):
        export([tmp_path / "c.mcap"], tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["c.mcap"]


def test_logs_of_different_rates_are_refused(trials: list[Log], tmp_path: Path) -> None:
    slow = tuple(dataclasses.replace(message, time=2 * message.time) for message in trials[1].messages)
    for name, log in (("a", trials[0]), ("b", dataclasses.replace(trials[1], messages=slow))):
        write_log(tmp_path / f"{name}.mcap", log)
    with pytest.raises(LogError, match=r"\.mcap has \d+ joint states a second, the first trial \d+"):
        export([tmp_path / "a.mcap", tmp_path / "b.mcap"], tmp_path / "out")
    assert not (tmp_path / "out").exists()
