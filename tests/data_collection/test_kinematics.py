from collections.abc import Iterator

import numpy as np
import pytest

from data_collection.joints import JOINT_NAMES
from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation
from data_collection.simulator import hand_model, robot_model
from data_collection.simulator.inverse_kinematics import look, reach
from data_collection.simulator.kinematics import HAND, HEAD, REACH, Kinematics, rotation
from data_collection.simulator.world import World

LINKS = (
    hand_model.GRASP_LINK,
    robot_model.LEFT_EYE_LINK,
    "r_eye",
    "r_little_distal_phalanx",
    "r_thumb_distal_phalanx",
)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with World(Simulation()) as made:
        made.set_up((), None)
        yield made


@pytest.fixture(scope="module")
def kinematics(world: World) -> Kinematics:
    return world.kinematics


def _random(kinematics: Kinematics, number: int) -> np.ndarray:
    return generator(number, "angles").uniform(kinematics.lower, kinematics.upper)


def test_the_papers_joints() -> None:
    assert len(JOINT_NAMES) == 25
    assert len(HEAD) == 6
    assert len(HAND) == 9
    assert len(REACH) == 10
    assert len(set(JOINT_NAMES)) == 25


@pytest.mark.parametrize("link", LINKS)
@pytest.mark.parametrize("number", range(3))
def test_agrees_with_the_physics_engine(world: World, link: str, number: int) -> None:
    angles = _random(world.kinematics, number)
    world.robot.place(angles)
    physical = world.robot.link_pose(link)
    pose = world.kinematics.pose(link, angles)
    assert pose.position == pytest.approx(physical[:3], abs=1e-6)
    assert pose.axes == pytest.approx(rotation(physical[3:]), abs=1e-5)
    assert world.robot.joint_state()[0] == pytest.approx(angles, abs=1e-6)


@pytest.mark.parametrize("link", LINKS)
def test_derivatives(kinematics: Kinematics, link: str) -> None:
    angles = _random(kinematics, 5)
    pose = kinematics.pose(link, angles)
    for joint in range(len(angles)):
        step = np.zeros(len(angles))
        step[joint] = 1e-6
        ahead, behind = kinematics.pose(link, angles + step), kinematics.pose(link, angles - step)
        assert (ahead.position - behind.position) / 2e-6 == pytest.approx(pose.linear[:, joint], abs=1e-6)
        turned = np.cross(pose.angular[:, joint], pose.axes.T).T
        assert (ahead.axes - behind.axes) / 2e-6 == pytest.approx(turned, abs=1e-6)


@pytest.mark.parametrize("x", [0.15, 0.21, 0.30, 0.42])
@pytest.mark.parametrize("y", [-0.22, -0.1, 0.0, 0.1, 0.22])
@pytest.mark.parametrize("z", [-0.03, 0.07])
def test_the_hand_reaches_every_place_from_above(world: World, x: float, y: float, z: float) -> None:
    kinematics, target = world.kinematics, np.array([x, y, z])
    angles = reach(kinematics, target, world.rest_angles, world._comfortable)
    pose = kinematics.pose(hand_model.GRASP_LINK, angles)
    assert np.linalg.norm(pose.position - target) < 1e-3
    assert pose.axes[2, 2] < -0.85, "the palm looks down"
    assert (angles >= kinematics.lower).all()
    assert (angles <= kinematics.upper).all()
    others = np.setdiff1d(np.arange(25), REACH)
    assert np.array_equal(angles[others], world.rest_angles[others])


def test_out_of_reach_stays_within_limits(world: World) -> None:
    angles = reach(world.kinematics, np.array([2.0, 1.0, 0.0]), world.rest_angles, world._comfortable)
    assert np.isfinite(angles).all()
    assert (angles <= world.kinematics.upper).all()


@pytest.mark.parametrize("target", [(0.21, 0.0, -0.03), (0.28, 0.2, -0.03), (0.28, -0.2, -0.03), (0.42, 0.0, -0.05)])
def test_both_eyes_fixate_the_object(world: World, target: tuple[float, float, float]) -> None:
    angles = look(world.kinematics, np.array(target), world.rest_angles, world.rest_angles)
    for eye in (robot_model.LEFT_EYE_LINK, "r_eye"):
        pose = world.kinematics.pose(eye, angles)
        line = np.array(target) - pose.position
        missed = np.degrees(np.arccos(pose.axes[:, 0] @ line / np.linalg.norm(line)))
        assert missed < 1.5, eye


def test_model_has_no_paths_and_is_whole() -> None:
    text = robot_model.robot_urdf(meshes=False)
    assert 'filename="package://' in text
    assert 'filename="/' not in text
    assert max(len(line) for line in text.splitlines()) < 1000, "PyBullet breaks longer lines"
