"""Each message of the FAQ is produced, and is what the page shows."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from data_collection import limits
from data_collection.__main__ import main as data_collection
from data_collection.log.topics import BY_TOPIC, HAND_POSE, JOINT_STATES
from features import size_limits as table_limits
from features.transforms import _principal_components
from tests.docs.conditions import SMOKE, patched
from tests.docs.pages import ROOT, Block, blocks, matches
from tests.synthetic import OBJECTS_COLUMNS, TRIALS_COLUMNS, WORDS, own_rows, write_own_study, write_rows
from workflow.artifacts.store import Store
from workflow.execution import engine, forks, runner
from workflow.plan.config import ConfigError
from workflow.plan.loading import load_study

SHOWN = {block.heading: block for block in blocks((ROOT / "docs" / "faq.md").read_text(encoding="utf-8"))}


def refused(path: Path) -> str:
    """What the check says about a config."""
    with pytest.raises(ConfigError) as raised:
        load_study(path)
    return str(raised.value)


def changed(tmp_path: Path, **simulator: Any) -> str:
    """What the check says about the smoke study with a change of its experiment."""
    config = patched(yaml.safe_load(SMOKE.read_text(encoding="utf-8")), {"experiments": {"simulator": simulator}})
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    return refused(tmp_path / "config.yaml")


def unknown_key(tmp_path: Path) -> str:
    return changed(tmp_path, ROWS=[0])


def out_of_range(tmp_path: Path) -> str:
    return changed(tmp_path, ROW=[0, 140])


def key_twice(tmp_path: Path) -> str:
    config = tmp_path / "config.yaml"
    config.write_text(f"{SMOKE.read_text(encoding='utf-8')}    D: [9]\n", encoding="utf-8")
    return refused(config)


def no_word(tmp_path: Path) -> str:
    return refused(write_own_study(tmp_path, words={**WORDS, "color": ["=1+1", *WORDS["color"]]}))


def never_said(tmp_path: Path) -> str:
    return changed(tmp_path, words={**WORDS, "action": ["reach", "touch", "grasp", "watch"]})


def two_channels(tmp_path: Path) -> str:
    return changed(tmp_path, words={**WORDS, "object": ["box", "cup", "ball", "red"]})


def no_logs(tmp_path: Path) -> str:
    config = {"experiments": {"robot": {"logs": "my_robot", "words": WORDS, "D": [6]}}}
    (tmp_path / "config.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    return refused(tmp_path / "config.yaml")


def bad_table(tmp_path: Path) -> str:
    config = write_own_study(tmp_path)
    _, objects = own_rows()
    objects[3]["color"] = [0.05] * 10
    write_rows(objects, OBJECTS_COLUMNS, tmp_path / "objects.parquet")
    return refused(config)


def long_sentence(tmp_path: Path) -> str:
    config = write_own_study(tmp_path)
    trials, _ = own_rows()
    trials[3]["words"] = ["reach", "touch", "grasp", "look-at", "front"]
    write_rows(trials, TRIALS_COLUMNS, tmp_path / "trials.parquet")
    return refused(config)


def no_folder(_: Path) -> str:
    with pytest.raises(OSError, match="cannot be written") as raised:
        runner.run(SMOKE, Path("/proc/study"), 1, engine.DEFAULT, (), Store(Path("nowhere"), 0))
    return str(raised.value)


QUICK: Mapping[str, Callable[[Path], str]] = {
    "Unknown key": unknown_key,
    "Value out of range": out_of_range,
    "Key twice": key_twice,
    "Word or name refused": no_word,
    "Word that is never said": never_said,
    "Word in two channels": two_channels,
    "Logs not found": no_logs,
    "Feature table refused": bad_table,
    "Sentence too long": long_sentence,
    "The process that starts the jobs": lambda _: forks.ENDED,
    "Output folder refused": no_folder,
}
OTHER = {"Set-up", "Damaged log", "Objects not found", "Folder in use", "Fewer components"}


def show(block: Block, printed: str) -> None:
    """Fail, with both texts, unless the message is what the page shows."""
    assert matches(printed, block.code), f"the page shows\n{block.code}\nprinted was\n{printed}"


def test_every_message_is_produced_by_a_test() -> None:
    assert set(SHOWN) == set(QUICK) | OTHER


@pytest.mark.parametrize("heading", QUICK)
def test_a_config_is_refused_as_the_page_says(heading: str, tmp_path: Path) -> None:
    show(SHOWN[heading], QUICK[heading](tmp_path))


def test_set_up_without_python(tmp_path: Path, in_folder: Callable[..., str]) -> None:
    for name in ("Makefile", "environment.lock"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(ROOT / ".ci", tmp_path / ".ci")
    (tmp_path / "bin").mkdir()
    for name in ("rm", "cat", "cut", "sha256sum"):
        (tmp_path / "bin" / name).symlink_to(shutil.which(name) or f"/bin/{name}")
    make = shutil.which("make") or "make"
    show(SHOWN["Set-up"], in_folder(tmp_path, make, "setup", PATH=str(tmp_path / "bin")))


def test_a_damaged_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "trial_0001.mcap"
    log.write_bytes(b"\x89MCAP0\r\n" + bytes(1000) + b"\x89MCAP0\r\n")
    assert data_collection(["check", str(log)]) == 1
    captured = capsys.readouterr()
    show(SHOWN["Damaged log"], captured.err + captured.out)


def test_a_folder_in_use(tmp_path: Path, in_folder: Callable[..., str]) -> None:
    import fcntl

    (tmp_path / "out").mkdir()
    run = [sys.executable, "-m", "workflow", "run", "--config", str(SMOKE), "--out", str(tmp_path / "out")]
    with (tmp_path / "out" / ".running").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        show(SHOWN["Folder in use"], in_folder(ROOT, *run))


def test_fewer_components(caplog: pytest.LogCaptureFixture) -> None:
    import numpy as np

    _principal_components(np.random.default_rng(0).random((13, 40)), 30)
    show(SHOWN["Fewer components"], "\n".join(f"{one.levelname} {one.getMessage()}" for one in caplog.records))


@pytest.mark.slow
def test_objects_not_found(repository: Path, in_repository: Callable[..., str]) -> None:
    change = {"experiments": {"simulator": {"feature_extraction": {"detection": {"smallest_area": 100_000}}}}}
    config = patched(yaml.safe_load(SMOKE.read_text(encoding="utf-8")), change)
    (repository / "config" / "changed.yaml").write_text(yaml.safe_dump(config), encoding="utf-8")
    run = ["-m", "workflow", "run", "--config", "config/changed.yaml", "--out", "results", "--cores", "1"]
    show(SHOWN["Objects not found"], in_repository(sys.executable, *run, succeeds=False))


def test_the_limits_that_pages_name_are_those_of_the_readers() -> None:
    shown = {
        "own_features.md": (
            f"{table_limits.MAX_TABLE_ROWS:,} rows",
            f"{table_limits.MAX_TABLE_VALUES:,} numbers",
            f"{table_limits.MAX_TABLE_BYTES / 2**30:g} GiB",
            f"{table_limits.MAX_VECTOR_LENGTH:,} numbers",
            f"none beyond ±{table_limits.MAX_NUMBER:.0e}".replace("e+0", "e"),
        ),
        "logs.md": (
            f"{limits.MAX_LOG_BYTES / 2**20:g} MiB",
            f"{limits.MAX_MESSAGES:,} messages",
            f"{limits.MAX_PIXELS:,} pixels and {limits.MAX_IMAGE_BYTES / 2**20:g} MiB",
            f"at most {limits.MAX_MESSAGE_BYTES / 2**20:g} MiB",
            f"±{BY_TOPIC[JOINT_STATES].value.highest:g} rad",
            f"±{BY_TOPIC[HAND_POSE].value.highest:g} m",
        ),
    }
    for page, texts in shown.items():
        content = (ROOT / "docs" / page).read_text(encoding="utf-8")
        assert [text for text in texts if text not in content] == [], page
