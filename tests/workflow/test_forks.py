"""Jobs in forks: as good as processes of their own, and nobody is left behind."""

from __future__ import annotations

import multiprocessing.forkserver
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from threading import Event
from types import SimpleNamespace
from unittest.mock import patch

import psutil
import pytest
from snakemake.iocontainers import InputFiles

from data_collection.processor import PINNED
from tests.synthetic import write_own_study
from tests.workflow.runs import command, hashes, run
from workflow.artifacts.provenance import ROOT
from workflow.execution import forks, plugins

SCRIPTS = sorted((ROOT / "workflow" / "scripts").glob("*.py"))


@pytest.fixture
def in_forks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder in which forks run scripts, with the libraries of one short script loaded."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    forks.preload([ROOT / "workflow" / "scripts" / "scores.py"])
    yield tmp_path
    forks.stop()


@pytest.fixture
def in_light_forks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The same without any libraries."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    forks.preload([script(tmp_path, "")])
    yield tmp_path
    forks.stop()


def script(folder: Path, text: str) -> Path:
    path = folder / "script.py"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_fork_has_the_libraries_and_the_folder_of_the_run(in_forks: Path) -> None:
    text = "import sys, os\nopen('seen', 'w').write(f'{\"pandas\" in sys.modules} {__name__} {os.getcwd()}')"
    assert forks.run(script(in_forks, text)) == 0
    assert (in_forks / "seen").read_text() == f"True __main__ {in_forks}"


def test_a_fork_has_what_snakemake_gives_it(in_forks: Path) -> None:
    given = SimpleNamespace(rule="fit", input=InputFiles(fromdict={"trials": "a.parquet"}))
    text = "raise SystemExit(0 if snakemake.input.trials == 'a.parquet' and snakemake.rule == 'fit' else 1)"
    assert forks.run(script(in_forks, text), given) == 0


@pytest.mark.parametrize(
    ("text", "status"),
    [
        ("raise SystemExit(3)", 3),
        ("raise ValueError", 1),
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", -signal.SIGKILL),
    ],
)
def test_the_status_of_a_script(in_forks: Path, text: str, status: int) -> None:
    assert forks.run(script(in_forks, text)) == status


def test_no_job_sees_what_another_did(in_forks: Path) -> None:
    text = "import evaluation, os\nassert not hasattr(evaluation, 'x') and 'X' not in os.environ\n"
    path = script(in_forks, text + "evaluation.x = os.environ['X'] = '1'")
    assert [forks.run(path) for _ in range(3)] == [0, 0, 0]


def test_many_threads_get_their_own_status(in_forks: Path) -> None:
    paths = []
    for status in range(24):
        paths.append(in_forks / f"{status}.py")
        paths[-1].write_text(f"raise SystemExit({status})", encoding="utf-8")
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(forks.run, paths)) == list(range(24))


def test_stopping_leaves_no_process(in_forks: Path) -> None:
    assert forks.run(script(in_forks, "")) == 0
    server = multiprocessing.forkserver._forkserver._forkserver_pid  # type: ignore[attr-defined]
    os.kill(server, 0)
    forks.stop()
    with pytest.raises(ProcessLookupError):
        os.kill(server, 0)


def test_a_long_temporary_folder_is_no_hindrance(in_light_forks: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The fork server's socket is elsewhere, and jobs use the folder as they should."""
    forks.stop()
    monkeypatch.delitem(multiprocessing.current_process()._config, "tempdir", raising=False)  # type: ignore[attr-defined]
    long = in_light_forks / ("job_" * 20) / ("job_" * 20)
    long.mkdir(parents=True)
    monkeypatch.setenv("TMPDIR", str(long))
    monkeypatch.setattr(tempfile, "tempdir", None)
    forks.preload([script(in_light_forks, "")])
    text = "import tempfile; raise SystemExit(len(tempfile.gettempdir()) < 100)"
    assert forks.run(script(in_light_forks, text)) == 0


def test_a_server_that_is_killed_while_a_job_runs(in_light_forks: Path) -> None:
    text = "import os, signal; os.kill(os.getppid(), signal.SIGKILL)"
    assert forks.run(script(in_light_forks, text)) == forks.LOST


def test_a_server_that_ends_as_it_begins(in_light_forks: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    forks.stop()
    monkeypatch.delenv("LOADED_SCRIPTS")  # without which it fails
    with pytest.raises(forks.ServerEndedError, match="the process that starts the jobs has ended"):
        forks.run(script(in_light_forks, ""))


@pytest.mark.parametrize("interrupted", [True, False])
def test_what_keeps_jobs_from_starting_is_said_once(interrupted: bool, capsys: pytest.CaptureFixture[str]) -> None:
    executor = object.__new__(plugins._Forks)
    executor._cancelled, executor._reported = Event(), set()
    if interrupted:
        executor._cancelled.set()
    with patch.object(executor._cancelled, "wait", lambda _: interrupted):
        for _ in range(3):
            executor._report_once("it has ended")
    assert capsys.readouterr().err == ("" if interrupted else "it has ended\n")


def test_what_is_loaded_runs_no_thread() -> None:
    """A fork has the thread that forked only: a lock that another one held would never be released."""
    environment = {**os.environ, **PINNED, "LOADED_SCRIPTS": os.pathsep.join(map(str, SCRIPTS))}
    text = (
        "import os, sys, workflow.execution.loaded; print('torch' in sys.modules, len(os.listdir('/proc/self/task')))"
    )
    line = [sys.executable, "-c", text]
    done = subprocess.run(line, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["True", "1"]


@pytest.mark.slow
def test_the_same_bytes_as_in_processes_of_their_own(tmp_path: Path) -> None:
    config = write_own_study(tmp_path, seeds=1, ROW=[0])
    run(config, tmp_path / "forks")
    plain = ["--snakefile", str(ROOT / "Snakefile"), "--configfile", str(config), "--directory"]
    line = [sys.executable, "-m", "snakemake", *plain, str(tmp_path / "plain"), "--cores", "2"]
    (tmp_path / "plain").mkdir()
    subprocess.run(line, cwd=ROOT, env={**os.environ, "PYTHONPATH": str(ROOT)}, capture_output=True, check=True)
    assert hashes(tmp_path / "plain") == hashes(tmp_path / "forks") != {}


@pytest.mark.slow
def test_a_killed_group_leaves_nobody(tmp_path: Path) -> None:
    line = command(write_own_study(tmp_path, seeds=1, ROW=[0]), tmp_path / "out")
    with subprocess.Popen(line, cwd=ROOT, stderr=subprocess.DEVNULL, start_new_session=True) as process:
        while not list(tmp_path.glob("out/joblogs/*")):
            assert process.poll() is None
            time.sleep(0.1)
        os.killpg(process.pid, signal.SIGKILL)
    until = time.monotonic() + 20
    while left := _alive(process.pid):
        assert time.monotonic() < until, left
        time.sleep(0.1)


def _alive(group: int) -> list[psutil.Process]:
    """The processes of a group, but those that are dead and only wait to be noticed."""
    found = []
    for process in psutil.process_iter():
        with suppress(ProcessLookupError, psutil.NoSuchProcess):
            if os.getpgid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE:
                found.append(process)
    return found
