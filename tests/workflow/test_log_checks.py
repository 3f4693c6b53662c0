"""The logs that a config names are opened before anything starts: what passes, a run does not refuse."""

from __future__ import annotations

import dataclasses
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from data_collection.log import topics
from data_collection.log.mcap_log import Log, read_log, write_log
from features.log_check import check_log
from tests.features.conftest import Logs, Scene
from tests.workflow.runs import SMOKE
from workflow import __main__ as command
from workflow import command_line
from workflow.artifacts.remembered import recall, remember
from workflow.plan import log_checks
from workflow.plan.loading import load_study
from workflow.plan.log_checks import log_problems, unread_logs

WORDS = {
    "action": ["reach", "touch", "grasp", "look-at"],
    "position": ["front", "left", "right", "far"],
    "object": ["box", "cup", "ball", "cylinder"],
    "color": ["green", "red", "blue"],
}
Change = Callable[[Log], Log]


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of sound logs: six trials, and two instructions."""
    folder = tmp_path_factory.mktemp("robot")
    logs = Logs(Scene())
    write_log(folder / "calibration.mcap", logs.calibration())
    for set_name, made in (("train", logs.trials(6)), ("generation", logs.trials(2, acted=False))):
        for i, log in enumerate(made, start=1):
            write_log(folder / set_name / f"trial_{i:04}.mcap", log)
    return folder


@pytest.fixture
def logs(sound: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(sound, tmp_path / "robot"))


def config(folder: Path, **changes: Any) -> Path:
    own = {"logs": ".", "words": WORDS, "D": [3], "seeds": 1} | changes
    path = folder / "config.yaml"
    path.write_text(yaml.safe_dump({"methods": ["proposed"], "experiments": {"robot": own}}))
    return path


def found(folder: Path, memory: dict[str, Any] | None = None, **changes: Any) -> list[str]:
    """What is wrong with the logs of a folder, without the folder's name."""
    study = load_study(config(folder, **changes))
    problems = log_problems(study, {} if memory is None else memory, "1", lambda *_: None)
    return [problem.replace(f"{folder}/", "") for problem in problems]


def change(path: Path, changed: Change) -> None:
    write_log(path, changed(read_log(path)))


def value_of(topic: str, make: Callable[[Any], Any]) -> Change:
    def changed(log: Log) -> Log:
        made = (dataclasses.replace(m, value=make(m.value)) if m.topic == topic else m for m in log.messages)
        return dataclasses.replace(log, messages=tuple(made))

    return changed


def says(number: int) -> Change:
    return lambda log: dataclasses.replace(log, metadata={**log.metadata, "trial": str(number)})


def truth_says(**scene: str) -> Change:
    def told(text: Any) -> str:
        known = json.loads(text)
        known["objects"][0] |= scene
        return json.dumps(known)

    return value_of(topics.TRUTH_SCENE, told)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-500])


def test_sound_logs_have_no_problem(logs: Path) -> None:
    assert found(logs) == []
    assert found(logs, D=[6], trials_per_job=2, generation={"sentences": 0}) == []


SECOND = "train/trial_0002.mcap"
FAULTS: dict[str, tuple[str, Callable[[Path], object], list[str]]] = {
    "cut": (SECOND, cut, ["without its end"]),
    "an empty calibration": ("calibration.mcap", lambda path: path.write_bytes(b""), ["calibration.mcap: is empty"]),
    "no dots": (
        "calibration.mcap",
        lambda path: change(path, value_of(topics.CALIBRATION_MARKS, lambda image: np.full_like(image, 255))),
        ["does not show 5 × 6 dark dots"],
    ),
    "an unknown word": (
        SECOND,
        lambda path: change(path, value_of(topics.SENTENCE, lambda _: "grab red box")),
        [f"{SECOND}: 'grab' in “grab red box” not among the experiment's words: ball, "],
    ),
    "a sentence that is too long": (
        SECOND,
        lambda path: change(path, value_of(topics.SENTENCE, lambda _: "touch far red box red")),
        [f"{SECOND}: 5 words, but method proposed explains at most 4"],
    ),
    "a word of another channel in the truth": (
        SECOND,
        lambda path: change(path, truth_says(color="cup")),
        [f"{SECOND}: the truth says 'cup', not among the experiment's words of color: green, red, blue"],
    ),
    "another size": (
        SECOND,
        lambda path: change(path, value_of(topics.IMAGE_BEFORE, lambda image: image[::2, ::2])),
        [f"{SECOND}: /camera/before/compressed has 160 × 120 pixels"],
    ),
    "no object": (
        SECOND,
        lambda path: change(path, value_of(topics.IMAGE_BEFORE, lambda image: np.full_like(image, 242))),
        [f"{SECOND}: trial 2: 0 objects found; expected 1 to 3"],
    ),
    "the number of another": (
        SECOND,
        lambda path: change(path, says(5)),
        [
            f"train/trial_0003.mcap: says that it is trial 3, and {SECOND} before it that it is 5",
            f"train/trial_0004.mcap: says that it is trial 4, and {SECOND} before it that it is 5",
            f"train/trial_0005.mcap: says that it is trial 5, and so does {SECOND}",
        ],
    ),
    "an instruction among the actions": (
        SECOND,
        lambda path: shutil.copy(path.parents[1] / "generation/trial_0002.mcap", path),
        [f"{SECOND}: is the log of an instruction"],
    ),
    "other limits of the joints": (
        SECOND,
        lambda path: change(
            path, value_of(topics.JOINT_LOWER, lambda state: dataclasses.replace(state, position=state.position - 1))
        ),
        [f"{SECOND}: the limits of its joints are not those of train/trial_0001.mcap"],
    ),
    "a fault behind D, in the same job": ("train/trial_0006.mcap", cut, ["trial_0006.mcap: is an MCAP file without"]),
    "a fault of a test": ("generation/trial_0001.mcap", cut, ["generation/trial_0001.mcap: is an MCAP file without"]),
}


@pytest.mark.bad_input
@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_found_before_anything_starts(logs: Path, name: str) -> None:
    file, spoil, expected = FAULTS[name]
    spoil(logs / file)
    problems = found(logs)
    assert len(problems) == len(expected)
    for problem, part in zip(problems, expected, strict=True):
        assert problem.startswith("experiments.robot.logs: ")
        assert part in problem


def test_numbers_that_contradict_the_files_are_refused_whatever_one_job_takes(logs: Path) -> None:
    for i in range(1, 7):
        change(logs / f"train/trial_{i:04}.mcap", says(7 - i))
    few, many = (found(logs, trials_per_job=size) for size in (3, 10))
    assert few == many
    assert len(few) == 5
    for i in range(1, 7):
        change(logs / f"train/trial_{i:04}.mcap", says(100 + i))
    assert found(logs, trials_per_job=3) == []


DROP = {"detection": {"on_wrong_count": "drop"}}


def test_where_dropping_leaves_too_little_it_is_told(logs: Path) -> None:
    empty = value_of(topics.IMAGE_BEFORE, lambda image: np.full_like(image, 242))
    for i in (1, 2):
        change(logs / f"train/trial_{i:04}.mcap", empty)
    assert found(logs, D=[6], feature_extraction=DROP) == []
    [problem] = found(logs, D=[2, 6], feature_extraction=DROP)
    assert problem.startswith("experiments.robot.D[0]: of the first 2 trials 0 are left")
    for i in (1, 2):
        change(logs / f"generation/trial_{i:04}.mcap", empty)
    assert any("generation: no trial is left" in one for one in found(logs, D=[6], feature_extraction=DROP))


def test_a_log_is_opened_once(logs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    really = check_log

    def noted(path: Path, *rest: Any, **more: Any) -> Any:
        opened.append(path.name)
        return really(path, *rest, **more)

    monkeypatch.setattr(log_checks, "check_log", noted)
    memory: dict[str, Any] = {}
    assert found(logs, memory) == []
    assert len(opened) == 8
    remember(logs / "memory.json", memory)
    opened.clear()
    change(logs / SECOND, value_of(topics.SENTENCE, lambda _: "touch red box"))
    assert found(logs, recall(logs / "memory.json")) == []
    assert opened == ["trial_0002.mcap"]
    opened.clear()
    found(logs, memory, feature_extraction={"detection": {"blur": 1.0}})  # which may find other objects
    assert len(opened) == 8
    found(logs, memory, words=WORDS | {"color": ["green", "red"]}, feature_extraction={"detection": {"blur": 1.0}})
    assert len(opened) == 8


@pytest.mark.parametrize("content", ["", "{", "[1]", '{"a": 1}', "\\ud800"])
def test_a_memory_that_is_none_is_forgotten(tmp_path: Path, content: str) -> None:
    (tmp_path / "memory.json").write_text(content)
    assert recall(tmp_path / "memory.json") == {}
    remember(tmp_path / "memory.json" / "below", {"a": {}})  # where nothing can be written


def test_check_and_run_refuse_alike(
    logs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(command_line, "SECONDS_OF_SILENCE", -1.0)
    path = config(logs)
    check = ["workflow", "check", "--config", str(path)]
    monkeypatch.setattr("sys.argv", check)
    shutil.copy(logs / SECOND, logs / "train/trial_0009.mcap")
    assert command.main() == 0
    told = capsys.readouterr()
    assert "no problem found" in told.out
    assert f"note: {logs / 'train'}: not read, for their names or a gap before them: trial_0009.mcap" in told.out
    assert "8 of 8 logs opened" in told.err
    assert len(recall(tmp_path / "cache/checked_logs.json")) == 8
    cut(logs / SECOND)
    for arguments in (check, ["workflow", "run", "--config", str(path), "--out", str(tmp_path / "out")]):
        monkeypatch.setattr("sys.argv", arguments)
        assert command.main() == 2
        assert "trial_0002.mcap: is an MCAP file without its end" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_weights_are_loaded_before_anything_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    smoke = yaml.safe_load(SMOKE.read_text(encoding="utf-8"))
    smoke["experiments"]["simulator"]["feature_extraction"] = {"weights": "weights.pt"}
    path = tmp_path / "config.yaml"
    path.write_text(yaml.safe_dump(smoke), encoding="utf-8")
    (tmp_path / "weights.pt").write_bytes(b"no weights")
    for arguments in (["check"], ["run", "--out", str(tmp_path / "out")]):
        monkeypatch.setattr("sys.argv", ["workflow", *arguments, "--config", str(path)])
        assert command.main() == 2
        said = capsys.readouterr().err
        assert "experiments.simulator.feature_extraction.weights: weights " in said
        assert f"{tmp_path / 'weights.pt'} cannot be loaded" in said
    assert not (tmp_path / "out").exists()


def test_too_few_logs_are_told_with_what_is_there(logs: Path) -> None:
    (logs / "train/trial_0001.mcap").rename(logs / "train/trial_0000.mcap")
    with pytest.raises(
        ValueError, match=r"0 logs numbered without a gap .*there are also trial_0000\.mcap, trial_0002"
    ):
        load_study(config(logs))


def test_nothing_is_unread_among_sound_logs(logs: Path) -> None:
    assert list(unread_logs(load_study(config(logs)))) == []
