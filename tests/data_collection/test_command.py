import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from data_collection import log_differences
from data_collection.__main__ import main
from data_collection.image_files import save_gif
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError, Message, write_log
from data_collection.show import animation, brief


@pytest.fixture
def log_path(trials: list[Log], tmp_path: Path) -> Path:
    path = tmp_path / "trial_0003.mcap"
    write_log(path, trials[2])
    return path


def test_check(log_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(log_path)]) == 0
    assert "trial_0003.mcap: trial, " in capsys.readouterr().out


def test_check_names_the_bad_one(log_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = log_path.with_name("bad.mcap")
    bad.write_bytes(log_path.read_bytes()[:-100])
    assert main(["check", str(log_path), str(bad)]) == 1
    captured = capsys.readouterr()
    assert "bad.mcap" in captured.err
    assert "1 of 2 logs" in captured.out


def test_regenerate(log_path: Path, trials: list[Log], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["regenerate", str(log_path)]) == 0
    other = Log({**trials[2].metadata, "trial": "2"}, trials[2].messages)
    write_log(log_path, other)
    assert main(["regenerate", str(log_path)]) == 1
    assert "/truth/scene at 0 ns: values differ" in capsys.readouterr().out


def test_show(log_path: Path, tmp_path: Path) -> None:
    assert main(["show", str(log_path), "--every", "3", "--out", str(tmp_path / "out")]) == 0
    with Image.open(tmp_path / "out/trial_0003.png") as strip:
        assert strip.size[0] == 3 * 400
    with Image.open(tmp_path / "out/trial_0003.gif") as movie:
        assert getattr(movie, "n_frames", 1) > 2


def test_a_brief_clip_ends_with_the_end_of_the_action(trials: list[Log], tmp_path: Path) -> None:
    clip = brief(trials[2], pictures=4)
    assert 3 <= len(clip) <= 4
    everything = animation(trials[2], width=400, height=300, every=1)
    assert np.array_equal(clip[0], everything[0])
    assert np.array_equal(clip[-1], everything[-1])
    save_gif(tmp_path / "clip.gif", clip, rate=4.0, hold=2.0)
    with Image.open(tmp_path / "clip.gif") as movie:
        durations = []
        for number in range(getattr(movie, "n_frames", 1)):
            movie.seek(number)
            durations.append(movie.info["duration"])
    # Pictures that are the same are one picture, shown longer.
    assert sum(durations) == 250 * len(clip) + 2000
    assert durations[-1] >= 2250


def test_export(log_path: Path, tmp_path: Path) -> None:
    assert main(["export-lerobot", str(log_path.parent), "--out", str(tmp_path / "set")]) == 0
    assert (tmp_path / "set/meta/info.json").exists()
    assert main(["export-lerobot", str(log_path.parent), "--out", str(tmp_path / "set")]) == 1


@pytest.mark.parametrize(
    "scene",
    [
        {"attended": 7},
        {"objects": [{"object": "cup", "color": "red", "place": "left", "position": [float("nan"), 0.1]}]},
        {"objects": []},
    ],
)
def test_check_refuses_the_truth_that_a_study_refuses(
    trials: list[Log], tmp_path: Path, scene: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    def told(message: Message) -> Message:
        if message.topic != topics.TRUTH_SCENE:
            return message
        return replace(message, value=json.dumps(json.loads(str(message.value)) | scene))

    write_log(tmp_path / "trial_0001.mcap", replace(trials[0], messages=tuple(map(told, trials[0].messages))))
    assert main(["check", str(tmp_path / "trial_0001.mcap")]) == 1
    assert f"{topics.TRUTH_SCENE} or {topics.TRUTH_OUTCOME} is not as documented" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["regenerate", "show"])
@pytest.mark.parametrize(
    "odd", [{"places": {"left": [0.3, None]}}, {"places": {"left": [9, 9]}}, {"places": 3}, {"objects": [{}]}]
)
def test_odd_settings_of_a_log_are_no_traceback(
    trials: list[Log], tmp_path: Path, command: str, odd: dict[str, Any], capsys: pytest.CaptureFixture[str]
) -> None:
    settings = json.dumps(json.loads(trials[0].metadata["settings"]) | odd)
    path = tmp_path / "trial_0001.mcap"
    write_log(path, replace(trials[0], metadata=trials[0].metadata | {"settings": settings}))
    out = ["--out", str(tmp_path)] if command == "show" else []
    assert main([command, str(path), *out]) == 1
    assert f"{path}: its " in capsys.readouterr().err


def test_what_breaks_the_simulator_is_told_as_the_fault_of_the_log(
    trials: list[Log], monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*_: Any, **__: Any) -> None:
        raise IndexError("no place is left")

    monkeypatch.setattr(log_differences, "collect", stop)
    with pytest.raises(LogError, match=r"cannot be simulated again from its metadata \(IndexError: no place is left"):
        log_differences.regenerate(trials[0])


def test_an_instruction_is_one_moment_and_that_is_no_note(
    instruction: Log, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_log(tmp_path / "trial_0001.mcap", instruction)
    assert main(["check", str(tmp_path / "trial_0001.mcap")]) == 0
    assert "note" not in capsys.readouterr().out
