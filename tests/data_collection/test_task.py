import dataclasses
import itertools
import math
from collections import Counter

import pytest

from data_collection import task
from data_collection.exam import draw_instruction, draw_plan_for, draw_scene_with
from data_collection.seeding import generator
from data_collection.shapes import build
from data_collection.simulation_settings import ACTIONS, Simulation
from data_collection.task import Outcome, Placed

NOTHING = Outcome(0.3, 0.0, 0.5, 0.0, 0.001, ())
FORCE, RISE = Simulation().tutor.contact, Simulation().tutor.held * Simulation().motion.lift_height


def _radius(placed: Placed) -> float:
    return build(placed.kind.shape, placed.kind.size, placed.kind.height, placed.kind.style).radius


@pytest.mark.parametrize("name", ["simulation", "real"])
def test_scenes(name: str, request: pytest.FixtureRequest) -> None:
    simulation: Simulation = request.getfixturevalue(name)
    counts: Counter[int] = Counter()
    seen: Counter[tuple[str, str]] = Counter()
    for number in range(300):
        scene = task.draw_scene(generator(3, "scene", number), simulation)
        counts[len(scene)] += 1
        assert len({item.place for item in scene}) == len(scene), "one object a place"
        assert len({item.kind for item in scene}) == len(scene)
        for item in scene:
            seen[item.kind.object, item.kind.color] += 1
            x, y = item.position
            assert math.dist((x, y), simulation.places[item.place]) <= simulation.place_cut * simulation.place_spread
            assert simulation.table.near < x < simulation.table.far
            assert abs(y) < 0.25
        for one, other in itertools.combinations(scene, 2):
            assert math.dist(one.position, other.position) >= _radius(one) + _radius(other) + simulation.gap
    assert set(counts) == {1, 2, 3}
    assert min(counts.values()) > 60
    assert set(seen) == {(kind.object, kind.color) for kind in simulation.kinds()}


@pytest.mark.parametrize("name", ["simulation", "real"])
def test_instructions(name: str, request: pytest.FixtureRequest) -> None:
    simulation: Simulation = request.getfixturevalue(name)
    said: set[str] = set()
    for trial in range(1, 13):
        scene, target, action = draw_instruction(simulation, (name, "generation", trial), 1)
        words = task.channel_words(simulation, action, scene[target])
        fits = [
            index
            for index, item in enumerate(scene)
            if (item.kind.object, item.kind.color, item.place) == (words["object"], words["color"], words["position"])
        ]
        assert fits == [target]
        assert len(scene) in (2, 3)
        others = [item for index, item in enumerate(scene) if index != target]
        assert any(item.kind.object == words["object"] or item.kind.color == words["color"] for item in others)
        said |= set(words.values())
    kinds = simulation.kinds()
    expected = {kind.object for kind in kinds} | {kind.color for kind in kinds} | set(simulation.places)
    assert said == expected | set(simulation.actions.values()), "every word occurs in 12 instructions"


def test_instructed_object_is_not_always_at_the_same_index() -> None:
    targets = {draw_instruction(Simulation(), ("e", "generation", trial), 1)[1] for trial in range(1, 13)}
    assert targets == {0, 1, 2}


def test_no_room_is_an_error() -> None:
    simulation = Simulation.model_validate(
        {"places": {"a": [0.3, 0.0], "b": [0.31, 0.0], "c": [0.3, 0.01]}, "place_spread": 0.0}
    )
    with pytest.raises(ValueError, match="no room"):
        task.arrange(generator(1, "close"), simulation, simulation.kinds()[:3], ["a", "b", "c"])


@pytest.mark.parametrize(
    ("change", "action"),
    [
        ({"displacement": 0.001}, "look-at"),
        ({"displacement": 0.001, "force": FORCE}, "look-at"),
        ({}, "reach"),
        ({"finger_rate": 1.0}, "reach"),
        ({"force": 0.99 * FORCE}, "reach"),
        ({"force": FORCE}, "touch"),
        ({"force": FORCE, "rise": 0.99 * RISE}, "touch"),
        ({"force": FORCE, "rise": RISE}, "grasp"),
        ({"force": FORCE, "rise": RISE, "finger_rate": 0.1}, "touch"),
    ],
)
def test_the_tutors_criteria(change: dict[str, float], action: str) -> None:
    judged = task.judge(dataclasses.replace(NOTHING, **change), Simulation())
    assert judged == task.Judgement(change.get("force", 0.0) >= FORCE, change.get("rise", 0.0) >= RISE, action)


def test_sentence_has_one_word_a_channel_in_any_order() -> None:
    words = {"action": "reach", "position": "left", "object": "cup", "color": "red"}
    orders = {task.utter(generator(1, number), words) for number in range(400)}
    assert len(orders) == 24
    assert all(sorted(order) == sorted(words.values()) for order in orders)


def test_plans() -> None:
    simulation = Simulation()
    plans = [task.draw_plan(generator(1, number), simulation, 3) for number in range(2000)]
    still = sum(not plan.moves for plan in plans) / len(plans)
    assert still == pytest.approx(simulation.motion.look_share, abs=0.03)
    assert {plan.attended for plan in plans} == {0, 1, 2}
    assert all(plan.offset[2] >= simulation.motion.height_least for plan in plans if plan.moves)
    assert all(0.0 <= plan.finger_rate <= 1.0 for plan in plans)


def test_actions_are_the_four() -> None:
    assert set(Simulation().actions) == set(ACTIONS)


@pytest.mark.parametrize("name", ["simulation", "real"])
def test_scenes_with_what_is_attended_are_otherwise_as_those_of_training(
    name: str, request: pytest.FixtureRequest
) -> None:
    simulation: Simulation = request.getfixturevalue(name)
    kind, place = simulation.kinds()[4], "left"
    counts, indices, others = Counter[int](), Counter[int](), Counter[tuple[str, str]]()
    for number in range(300):
        scene, attended = draw_scene_with(generator(3, "scene", number), simulation, kind, place)
        assert (scene[attended].kind, scene[attended].place) == (kind, place)
        assert len({item.place for item in scene}) == len({item.kind for item in scene}) == len(scene)
        counts[len(scene)] += 1
        indices[attended] += len(scene) == 3
        others.update((item.kind.object, item.kind.color) for item in scene if item.kind != kind)
    assert set(counts) == {1, 2, 3}
    assert min(counts.values()) > 60
    assert set(indices) == {0, 1, 2}
    assert min(indices.values()) > 15
    assert set(others) == {(each.object, each.color) for each in simulation.kinds() if each != kind}


@pytest.mark.parametrize("action", ACTIONS)
def test_plans_for_a_word(action: str) -> None:
    simulation = Simulation.model_validate({"tutor": {"bend": 0.6}, "motion": {"look_share": 1.0}})
    plans = [draw_plan_for(generator(1, number), simulation, 2, action) for number in range(400)]
    rates = [plan.finger_rate for plan in plans]
    assert {plan.attended for plan in plans} == {2}
    assert {plan.moves for plan in plans} == {action != "look-at"}, "whatever the robot does on its own account"
    if action == "look-at":
        assert plans[0] == task.Plan(2, moves=False, offset=(0.0, 0.0, 0.0), finger_rate=0.0)
        return
    assert min(plan.offset[2] for plan in plans) == simulation.motion.height_least
    assert len({plan.offset for plan in plans}) == len(plans)
    least = 0.6 if action == "grasp" else 0.0
    assert least <= min(rates) < least + 0.02
    assert 0.98 < max(rates) <= 1.0
