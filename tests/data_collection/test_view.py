import math

import numpy as np
import pytest

from data_collection.log.messages import Floats
from data_collection.shapes import build
from data_collection.simulation_settings import Simulation
from data_collection.simulator import robot_model
from data_collection.simulator.scene import intrinsics
from data_collection.simulator.world import World


def _pixels(simulation: Simulation, points: Floats) -> Floats:
    """Return where points (N, 3) are seen from the rest posture, (N, 2) columns and rows."""
    with World(simulation) as world:
        pose = world.kinematics.pose(robot_model.LEFT_EYE_LINK, world.rest_angles)
    local = (points - pose.position) @ pose.axes
    optical = np.column_stack([-local[:, 1], -local[:, 2], local[:, 0]])
    projected = optical @ intrinsics(simulation.camera).T
    return np.asarray(projected[:, :2] / projected[:, 2:], dtype=np.float64)


@pytest.mark.parametrize("name", ["simulation", "real"])
def test_objects_never_leave_the_view(name: str, request: pytest.FixtureRequest) -> None:
    """Wherever a scene may put any object, all of it is in the picture."""
    simulation: Simulation = request.getfixturevalue(name)
    shapes = [build(kind.shape, kind.size, kind.height, kind.style) for kind in simulation.kinds()]
    reach = simulation.place_cut * simulation.place_spread + max(shape.radius for shape in shapes)
    angle = np.linspace(0, 2 * math.pi, 60)
    circle = reach * np.column_stack([np.cos(angle), np.sin(angle)])
    least = simulation.table.near + 0.005
    points = [
        (max(x + dx, least), y + dy, simulation.table.height + height)
        for x, y in simulation.places.values()
        for dx, dy in circle
        for height in (0.0, max(shape.height for shape in shapes))
    ]
    seen = _pixels(simulation, np.array(points))
    assert (seen > 2).all(), seen.min(axis=0)
    assert (seen < np.array([simulation.camera.width, simulation.camera.height]) - 3).all(), seen.max(axis=0)


def test_projection_agrees_with_the_rendered_dots(simulation: Simulation) -> None:
    from data_collection.episode import calibrate, mark_positions

    log = calibrate(simulation, experiment="e", seed=1, provenance={})
    picture = np.asarray(log.messages[2].value, dtype=np.float64).max(axis=2)
    marks = np.column_stack([mark_positions(), np.full(len(mark_positions()), simulation.table.height)])
    for column, row in _pixels(simulation, marks):
        window = 255.0 - picture[int(row) - 5 : int(row) + 7, int(column) - 6 : int(column) + 8]
        weight = np.where(window > 120, window, 0.0)
        assert weight.sum() > 0
        rows, columns = np.mgrid[int(row) - 5 : int(row) + 7, int(column) - 6 : int(column) + 8]
        assert (weight * columns).sum() / weight.sum() == pytest.approx(column, abs=0.5)
        assert (weight * rows).sum() / weight.sum() == pytest.approx(row, abs=0.5)
