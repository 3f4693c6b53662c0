from pathlib import Path

import pytest

from data_collection.episode import calibrate, collect, execute
from data_collection.log.mcap_log import Log
from data_collection.simulation_settings import Simulation
from data_collection.task import Command
from tests.conftest import simulation_of

PROVENANCE = {"code_sha256": "c0de", "lock_sha256": "10c4"}


@pytest.fixture(scope="session")
def simulation() -> Simulation:
    return Simulation()


@pytest.fixture(scope="session")
def real() -> Simulation:
    return simulation_of("real")


@pytest.fixture(scope="session")
def trials(simulation: Simulation) -> list[Log]:
    """Trials 1 to 4 of the simulator, collected one after the other in one process."""
    return list(
        collect(
            simulation, experiment="simulator", set_name="train", trials=range(1, 5), seed=1, provenance=PROVENANCE
        )
    )


@pytest.fixture(scope="session")
def real_trial(real: Simulation) -> Log:
    return next(collect(real, experiment="real", set_name="train", trials=[2], seed=1, provenance=PROVENANCE))


@pytest.fixture(scope="session")
def instruction(simulation: Simulation) -> Log:
    return next(
        collect(simulation, experiment="simulator", set_name="generation", trials=[1], seed=1, provenance=PROVENANCE)
    )


@pytest.fixture(scope="session")
def calibration_log(simulation: Simulation) -> Log:
    return calibrate(simulation, experiment="simulator", seed=1, provenance=PROVENANCE)


@pytest.fixture(scope="session")
def executed(simulation: Simulation) -> Log:
    command = Command(trial=1, gaze=(0.3, 0.0), target=None, finger_rate=0.0)
    return next(execute(simulation, experiment="simulator", seed=1, commands=[command], provenance=PROVENANCE))


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for cases that are too many to have one each."""
    return tmp_path_factory.mktemp("hostile_logs")
