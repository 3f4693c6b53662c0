"""Machines that lack what libraries take for granted: a home folder, a name, room for a socket, packages."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import pytest

from workflow.__main__ import leave_out_foreign_packages
from workflow.artifacts.provenance import ROOT
from workflow.artifacts.store import Store
from workflow.execution import engine, runner, surroundings
from workflow.execution.surroundings import settle, short_temporary_folder, takes_files

UNWRITABLE = Path("/proc")  # where not even root makes files


def no_entry() -> str:
    raise KeyError("getpwuid(): uid not found: 12345")


def no_home() -> Path:
    raise RuntimeError("Could not determine home directory.")


def test_a_machine_that_has_everything_is_left_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("getpass.getuser", lambda: "me")
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    environment: dict[str, str] = {}
    settle(tmp_path / "out", environment)
    assert environment == {}


def test_a_user_without_name_and_home(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("getpass.getuser", no_entry)
    monkeypatch.setattr(Path, "home", no_home)
    environment: dict[str, str] = {}
    settle(tmp_path, environment)
    assert environment == {"LOGNAME": f"user{os.getuid()}", "HOME": str(tmp_path / ".home")}
    assert (tmp_path / ".home").is_dir()


def test_a_home_that_takes_no_files(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What is in it may still be read, such as weights."""
    monkeypatch.setattr("getpass.getuser", lambda: "me")
    monkeypatch.setattr(Path, "home", lambda: UNWRITABLE / "me")
    environment: dict[str, str] = {}
    settle(tmp_path, environment)
    assert environment == {
        "MPLCONFIGDIR": str(tmp_path / ".home" / "matplotlib"),
        "XDG_CACHE_HOME": str(tmp_path / ".home" / "cache"),
        "TORCH_HOME": "/proc/me/.cache/torch",
    }
    named = {"MPLCONFIGDIR": "mine", "XDG_CACHE_HOME": str(tmp_path)}
    environment = dict(named)
    settle(tmp_path, environment)
    assert environment == named


def test_a_temporary_folder_that_is_not_there_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settle(tmp_path, {"TMPDIR": "/no/such"})
    assert capsys.readouterr().err == f"TMPDIR=/no/such: is no folder; {tempfile.gettempdir()} is used\n"


def test_which_folders_take_files(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert takes_files(tmp_path / "not" / "yet" / "there")
    assert not takes_files(UNWRITABLE / "me")
    assert not takes_files(tmp_path / "file" / "below")


@pytest.fixture
def long_temporary_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / ("job_" * 20) / ("job_" * 20)
    folder.mkdir(parents=True)
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def test_a_socket_has_room(long_temporary_folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with short_temporary_folder():
        socket = Path(tempfile.mkdtemp(prefix="pymp-")) / "listener-12345678"
        socket.parent.rmdir()
        assert len(str(socket)) <= surroundings.LONGEST_SOCKET
    assert tempfile.tempdir == str(long_temporary_folder)  # for everything else
    monkeypatch.setattr(surroundings, "_SHORT_FOLDERS", (str(UNWRITABLE),))
    with (
        pytest.raises(ValueError, match=r"set TMPDIR to a folder of at most 75 characters"),
        short_temporary_folder(),
    ):
        pass


def test_packages_of_another_python_are_left_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "yaml.py").write_text("raise ImportError('for another Python')")
    kept = [str(ROOT), "/usr/lib/python3.11"]
    monkeypatch.setattr(sys, "path", [str(ROOT), str(tmp_path), "/usr/lib/python3.11"])
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(ROOT), f"{tmp_path}/x/..", ""]))
    leave_out_foreign_packages()
    assert list(dict.fromkeys(sys.path)) == kept
    assert "PYTHONPATH" not in os.environ


@pytest.mark.parametrize(
    ("out", "says"),
    [
        (UNWRITABLE / "study", r"/proc/study: cannot be written \(.*\); name another --out"),
        (Path(__file__), r"test_machines\.py: is a file, not a folder; name another --out"),
    ],
    ids=["unwritable", "file"],
)
def test_an_output_folder_that_cannot_be_one(out: Path, says: str) -> None:
    with pytest.raises(OSError, match=says):
        runner.run(ROOT / "config" / "smoke.yaml", out, 1, engine.DEFAULT, (), Store(Path("nowhere"), 0))
