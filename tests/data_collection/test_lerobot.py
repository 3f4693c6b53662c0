import dataclasses
import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from PIL import Image

from data_collection.__main__ import main
from data_collection.joints import JOINT_NAMES
from data_collection.lerobot.export import export
from data_collection.lerobot.features import IMAGE_KEY
from data_collection.lerobot.statistics import _quantile
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError, Message, write_log
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


def test_each_episode_has_the_statistics_of_its_frames(dataset: Path) -> None:
    """As LeRobot writes them itself: with other columns, its tools cannot add an episode, or take one away."""
    rows = pd.read_parquet(dataset / "meta/episodes/chunk-000/file-000.parquet")
    stats = json.loads((dataset / "meta/stats.json").read_text())
    names = {"min", "max", "mean", "std", "count", "q01", "q10", "q50", "q90", "q99"}
    assert {key: set(own) for key, own in stats.items()} == dict.fromkeys(stats, names)
    own = {column for column in rows.columns if column.startswith("stats/")}
    assert own == {f"stats/{key}/{name}" for key in stats for name in names}
    table = parquet.read_table(dataset / "data/chunk-000/file-000.parquet").to_pandas()
    row, frames = rows.iloc[1], table[table["episode_index"] == 1]
    states = np.stack(frames["observation.state"].to_list())
    pixels = np.stack([np.asarray(Image.open(io.BytesIO(one["bytes"]))) for one in frames[IMAGE_KEY]])
    for name, value in {
        "min": states.min(axis=0),
        "max": states.max(axis=0),
        "mean": states.mean(axis=0),
        "std": states.std(axis=0),
        "q10": np.quantile(states, 0.1, axis=0),
        "q99": np.quantile(states, 0.99, axis=0),
    }.items():
        np.testing.assert_allclose(row[f"stats/observation.state/{name}"], value, atol=1e-5)
    for name, value in {"min": pixels.min(axis=(0, 1, 2)), "mean": pixels.mean(axis=(0, 1, 2))}.items():
        found = np.array(json.loads(json.dumps(row[f"stats/{IMAGE_KEY}/{name}"], default=list)))
        assert found.shape == (3, 1, 1)
        np.testing.assert_allclose(255 * found.ravel(), value, atol=1e-3)
    assert list(row["stats/action/count"]) == list(row[f"stats/{IMAGE_KEY}/count"]) == [len(frames)]
    levels = np.zeros((3, 256), dtype=np.int64)
    levels[:, [10, 20, 200]] = [[10, 80, 10], [9, 81, 10], [100, 0, 0]]
    assert np.round(_quantile(levels, 0.1) * 255).tolist() == [10, 20, 10]
    assert np.round(_quantile(levels, 0.99) * 255).tolist() == [200, 200, 10]
    assert stats[IMAGE_KEY]["count"] == stats["action"]["count"] == [len(table)]


def test_an_episode_can_be_added(dataset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """LeRobot writes it into files beside these, and then reads all files of a kind as one table."""
    monkeypatch.setenv("HF_HUB_OFFLINE", "1")
    datasets = pytest.importorskip("datasets")
    first = dataset / "meta/episodes/chunk-000/file-000.parquet"
    added = {"episode_index": 4, "tasks": ["touch it"], "length": 7, "dataset_from_index": 0, "dataset_to_index": 7}
    added |= {f"{kind}/{which}_index": 1 for kind in ("data", "meta/episodes") for which in ("chunk", "file")}
    for key, own in json.loads((dataset / "meta/stats.json").read_text()).items():
        added |= {f"stats/{key}/{name}": value for name, value in own.items()}
    second = tmp_path / "file-001.parquet"
    parquet.write_table(pa.Table.from_pylist([added]), second)
    both = datasets.Dataset.from_parquet([str(first), str(second)], cache_dir=str(tmp_path))
    assert len(both) == len(pd.read_parquet(first)) + 1


def moved(log: Log, change: Callable[[Message], int | None]) -> Log:
    """The log with other times; None leaves a message out."""
    kept = [(change(message), message) for message in log.messages]
    made = [dataclasses.replace(message, time=time) for time, message in kept if time is not None]
    return dataclasses.replace(log, messages=tuple(sorted(made, key=lambda message: message.time)))


def frames_of(log: Log, folder: Path) -> tuple[int, list[str]]:
    """How many frames an export has, and what it notes."""
    write_log(folder / "trial_0001.mcap", log)
    notes = export([folder / "trial_0001.mcap"], folder / "out")
    return json.loads((folder / "out/meta/info.json").read_text())["total_frames"], notes


def test_no_frame_vanishes_without_a_word(trials: list[Log], tmp_path: Path) -> None:
    states = [message for message in trials[0].messages if message.topic == topics.JOINT_STATES]
    cases: dict[str, tuple[Callable[[Message], int | None], int, str]] = {
        "as it is": (lambda m: m.time, len(states), ""),
        "since 1970": (lambda m: m.time + 1_790_000_000_000_000_000, len(states), ""),
        "a late picture": (
            lambda m: m.time + 225_000_000 * (m.topic == topics.IMAGE_BEFORE),
            len(states),
            f"5 of {len(states)} frames are before the first picture, and show it",
        ),
        "touch only at the end": (
            lambda m: None if m.topic == topics.TACTILE and m.time < states[-2].time else m.time,
            2,
            f"{len(states) - 2} of {len(states)} frames are left out",
        ),
        "two and two at a time": (
            lambda m: m.time // 100_000_000 * 100_000_000,
            len(states),
            "joint states have the time of the one before",
        ),
        "a pause": (lambda m: m.time + 10**9 * (m.time > 400_000_000), len(states), "none for 1.05 s"),
    }
    for name, (change, count, says) in cases.items():
        (tmp_path / name).mkdir()
        frames, notes = frames_of(moved(trials[0], change), tmp_path / name)
        assert frames == count, name
        assert says in "\n".join(notes), name
        assert bool(notes) == bool(says), name


def test_one_time_for_all_is_refused(trials: list[Log], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number, time in enumerate((0, 1_790_000_000_000_000_000)):
        path = tmp_path / f"trial_000{number}.mcap"
        write_log(path, moved(trials[0], lambda message, time=time: time))  # type: ignore[misc]
        with pytest.raises(LogError, match=rf"all \d+ joint states have the time {time} ns"):
            export([path], tmp_path / "out")
        assert main(["check", str(path)]) == 0  # a study needs no more than the order
        assert f"note: all messages have the time {time} ns" in capsys.readouterr().out
