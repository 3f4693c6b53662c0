"""Fixtures that several packages' tests share, and what the summary of a run says beside passed and failed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml
from filelock import FileLock

from data_collection.log.mcap_log import Log, read_log
from data_collection.simulation_settings import Simulation
from tests.workflow.runs import SMOKE, run

ROOT = Path(__file__).parents[1]
STUDY = ROOT / "config" / "config.yaml"
TRIALS = 200
# Copies of the project that tests make find there what is compiled, as long as they do not change the model.
os.environ.setdefault("NUMBA_CACHE_DIR", str(ROOT / "model" / "__pycache__"))


def simulation_of(experiment: str) -> Simulation:
    """The simulation of an experiment of the study."""
    config = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    return Simulation.model_validate(config["experiments"][experiment].get("simulation", {}))


@dataclass(frozen=True)
class Simulated:
    """Many simulated training trials of an experiment of the study, and their camera calibration."""

    experiment: str
    simulation: Simulation
    folder: Path

    def trials(self) -> list[Path]:
        """The paths of the logs, by trial."""
        return sorted(self.folder.glob("trial_*.mcap"))

    def calibration(self) -> Log:
        """The log of the calibration."""
        return read_log(self.folder / "calibration.mcap")


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory) -> None:
    """No test reads or writes the user's cache."""
    os.environ["CACHE"] = str(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="session", params=["simulator", "real"])
def simulated(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Simulated:
    """200 trials of each experiment, simulated once a test run, also where several processes share the tests."""
    base = tmp_path_factory.getbasetemp()
    base = base.parent if hasattr(request.config, "workerinput") else base
    made = Simulated(request.param, simulation_of(request.param), base / f"simulated_{request.param}")
    with FileLock(f"{made.folder}.lock"):
        if not (made.folder / "calibration.mcap").is_file():
            made.folder.mkdir()
            line = [sys.executable, "-m", "tests.simulate", made.experiment, str(made.folder), str(TRIALS)]
            settings = made.simulation.model_dump_json()
            subprocess.run(line, cwd=STUDY.parents[1], input=settings, text=True, check=True)
    return made


@pytest.fixture(scope="session")
def finished(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The output folder of a finished smoke study, its cache beside it; made once a test run."""
    base = tmp_path_factory.getbasetemp()
    base = base.parent if hasattr(request.config, "workerinput") else base
    out = base / "finished_smoke"
    with FileLock(f"{out}.lock"):
        if not (out / "manifest.json").is_file():
            run(SMOKE, out)
    return out


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what was measured, and how many bad inputs of each kind were refused, out of how many tried."""
    tried: Counter[str] = Counter()
    refused: Counter[str] = Counter()
    for outcome in ("passed", "failed"):
        for report in terminalreporter.getreports(outcome):
            if report.when != "call":
                continue
            for name, value in report.user_properties:
                terminalreporter.write_line(f"measured in {report.nodeid}: {name} {value}")
            if "bad_input" in report.keywords:
                file = report.nodeid.split("::")[0]
                tried[file] += 1
                refused[file] += outcome == "passed"
    for file in sorted(tried):
        terminalreporter.write_line(f"bad inputs refused in {file}: {refused[file]} of {tried[file]}")
