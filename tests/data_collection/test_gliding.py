"""The arm glides while nothing is near: as the physics would move it, and the same bytes in any order of trials."""

from pathlib import Path

import numpy as np
import pytest

from data_collection.episode import collect
from data_collection.log.mcap_log import Log, write_log
from data_collection.simulation_settings import Simulation
from data_collection.simulator import recording
from data_collection.simulator.world import World
from data_collection.task import Placed


def _bytes(log: Log, path: Path) -> bytes:
    write_log(path, log)
    return path.read_bytes()


@pytest.mark.parametrize("name", ["simulation", "real"])
def test_the_same_bytes_in_another_order(name: str, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    simulation: Simulation = request.getfixturevalue(name)
    made: dict[int, bytes] = {}
    for order in ((1, 2, 3), (3, 1, 3, 2)):
        logs = collect(simulation, experiment=name, set_name="train", trials=order, seed=1, provenance={})
        for trial, log in zip(order, logs, strict=True):
            assert made.setdefault(trial, written := _bytes(log, tmp_path / "log.mcap")) == written, trial


def _moved(simulation: Simulation, height: float, rate: float) -> list[recording.Sample]:
    """What is sensed while the hand goes to a height, metres, above where it holds a box at the front best."""
    placed = Placed(simulation.kinds()[0], "front", simulation.places["front"], 0.3)
    with World(simulation) as world:
        world.set_up([placed], None)
        target = world.best_grasp(0) + np.array([0.0, 0.0, height])
        return list(world.act(0, target, rate, np.zeros(2), lifts=bool).samples)


def test_it_glides_as_the_physics_would_move_it(simulation: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    gliding = _moved(simulation, 0.1, 0.3)
    monkeypatch.setattr(recording, "_NEAR", 10.0)  # metres: something is always near
    physical = _moved(simulation, 0.1, 0.3)
    assert len(gliding) == len(physical)
    for one, other in zip(gliding, physical, strict=True):
        assert one.position == pytest.approx(other.position, abs=2e-5)
        assert one.velocity == pytest.approx(other.velocity, abs=1e-3)
        assert one.objects == pytest.approx(other.objects, abs=1e-3)


def test_what_is_touched_is_physics(simulation: Simulation) -> None:
    """The hand does not glide through what it closes on."""
    assert _moved(simulation, 0.0, 0.9)[-1].touch.max() > 0.3
