"""What test sets are about: every word equally often, however many trials there are."""

import itertools
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from data_collection.apparatus import ObjectKind
from data_collection.design import Target, block_size, spread, target
from data_collection.simulation_settings import Simulation
from tests.conftest import simulation_of

SIZES = range(1, 101)
WORDS: dict[str, Callable[[Target], str]] = {
    "action": lambda one: one.action,
    "position": lambda one: one.place,
    "object": lambda one: one.kind.object,
    "color": lambda one: one.kind.color,
}
SHAPES = ("box", "cup", "ball", "car", "star")


def _targets(simulation: Simulation, count: int, *, set_name: str = "description", seed: int = 1) -> list[Target]:
    return [
        target(simulation, experiment="e", set_name=set_name, trial=trial, seed=seed) for trial in range(1, count + 1)
    ]


def _words(simulation: Simulation) -> dict[str, list[str]]:
    kinds = simulation.kinds()
    return {
        "action": list(simulation.actions),
        "position": list(simulation.places),
        "object": sorted({kind.object for kind in kinds}),
        "color": sorted({kind.color for kind in kinds}),
    }


def _kitchen(objects: int, colors: int, places: int) -> Simulation:
    """An experiment with other numbers of words, in which every object comes in every color."""
    shades = {f"c{i}": [[0.1 * i, 0.5, 0.5]] for i in range(colors)}
    kinds = [
        {"object": f"o{i}", "color": color, "shape": SHAPES[i], "size": 0.05}
        for i in range(objects)
        for color in shades
    ]
    spots = {f"p{i}": [0.2 + 0.03 * i, 0.0] for i in range(places)}
    return Simulation.model_validate({"objects": kinds, "colors": shades, "places": spots, "objects_most": 1})


def _imbalance(values: Sequence[str], words: Sequence[str]) -> int:
    counts = Counter(values)
    return max(counts[word] for word in words) - min(counts[word] for word in words)


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("set_name", ["generation", "description"])
@pytest.mark.parametrize("experiment", ["simulator", "real"])
def test_every_word_is_due_equally_often_in_sets_of_every_size(experiment: str, set_name: str, seed: int) -> None:
    simulation = simulation_of(experiment)
    targets = _targets(simulation, SIZES[-1], set_name=set_name, seed=seed)
    for channel, words in _words(simulation).items():
        said = [WORDS[channel](one) for one in targets]
        assert max(_imbalance(said[:size], words) for size in SIZES) == 1, channel


@pytest.mark.parametrize(("objects", "colors", "places"), [(2, 2, 2), (5, 3, 4), (1, 4, 3), (5, 7, 2)])
def test_other_numbers_of_words(objects: int, colors: int, places: int) -> None:
    simulation = _kitchen(objects, colors, places)
    targets = _targets(simulation, SIZES[-1])
    for channel, words in _words(simulation).items():
        said = [WORDS[channel](one) for one in targets]
        assert max(_imbalance(said[:size], words) for size in SIZES) <= 1, channel


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("experiment", ["simulator", "real"])
def test_words_are_as_independent_as_counts_allow(experiment: str, seed: int) -> None:
    """Position, object and color meet as evenly as can be in sets of the paper's sizes, and all words nearly so."""
    simulation = simulation_of(experiment)
    words, kinds = _words(simulation), simulation.kinds()
    allowed = {("object", "color"): {(kind.object, kind.color) for kind in kinds}}
    targets = _targets(simulation, 36, seed=seed)
    for one, other in itertools.combinations(WORDS, 2):
        possible = allowed.get((one, other), set(itertools.product(words[one], words[other])))
        for size in range(1, 37):
            met = Counter((WORDS[one](due), WORDS[other](due)) for due in targets[:size])
            counts = [met[pair] for pair in possible]
            assert sum(counts) == size, "nothing else is met"
            most = 1 if size <= 14 and one != "action" else 2
            assert max(counts) - min(counts) <= most, (one, other, size)


def test_only_objects_that_there_are(real: Simulation) -> None:
    due = [one.kind for one in _targets(real, 100)]
    assert set(due) == set(real.kinds()), "each takes its turn"


def test_objects_that_are_called_the_same_take_turns() -> None:
    def cup(size: float, color: str) -> ObjectKind:
        return ObjectKind(object="cup", color=color, shape="cup", size=size)

    kinds = (cup(0.05, "red"), cup(0.056, "red"), cup(0.06, "red"), cup(0.05, "blue"))
    simulation = Simulation(objects=kinds, objects_most=1)
    red = [one.kind for one in _targets(simulation, 36) if one.kind.color == "red"]
    assert len(red) == 18
    assert Counter(red) == dict.fromkeys(kinds[:3], 6)


def test_words_that_cannot_be_due_equally_often_come_as_near_as_they_can() -> None:
    """Boxes and cups are red, only balls are blue: colors equally often would make balls as many as the others."""
    kinds = tuple(
        ObjectKind(object=shape, color=color, shape=shape)
        for shape, color in (("box", "red"), ("cup", "red"), ("ball", "blue"))
    )
    targets = _targets(Simulation(objects=kinds), 36)
    objects, colors = (Counter(WORDS[channel](one) for one in targets) for channel in ("object", "color"))
    assert 12 <= objects["ball"] <= 18
    assert colors["blue"] == objects["ball"]
    assert abs(objects["box"] - objects["cup"]) <= 1
    for channel in ("action", "position"):
        assert set(Counter(WORDS[channel](one) for one in targets).values()) == {9}


def test_what_is_due_depends_on_the_names_alone(simulation: Simulation) -> None:
    """Trials are the same whichever are asked for, and in whatever order; other names give other ones."""

    def due(trial: int, *, experiment: str = "e", set_name: str = "description", seed: int = 1) -> Target:
        return target(simulation, experiment=experiment, set_name=set_name, trial=trial, seed=seed)

    forwards = [due(trial) for trial in range(1, 81)]
    assert [due(trial) for trial in range(80, 0, -1)] == forwards[::-1]
    for names in ({"experiment": "e.set2"}, {"set_name": "generation"}, {"seed": 2}):
        assert [due(trial, **names) for trial in range(1, 81)] != forwards
    assert forwards[:36] != forwards[36:72], "each part of the sequence is drawn by itself"


def test_known_beginnings(simulation: Simulation, real: Simulation) -> None:
    """A change of these changes every test set."""
    begun = {
        name: [
            (one.action, one.place, one.kind.object, one.kind.color)
            for one in (target(own, experiment=name, set_name="description", trial=i, seed=1) for i in (1, 2, 37))
        ]
        for name, own in (("simulator", simulation), ("real", real))
    }
    assert begun == {
        "simulator": [
            ("look-at", "right", "box", "green"),
            ("reach", "far", "cup", "red"),
            ("reach", "right", "box", "blue"),
        ],
        "real": [
            ("look-at", "front", "car", "red"),
            ("reach", "right", "star", "yellow"),
            ("grasp", "right", "ball", "red"),
        ],
    }


def test_parts_of_the_sequence_hold_each_word_equally_often(simulation: Simulation, real: Simulation) -> None:
    for own in (simulation, real):
        pairs = sorted({(kind.object, kind.color) for kind in own.kinds()})
        size = block_size(list(own.actions), list(own.places), pairs)
        assert size == 36
        assert all(size % len(words) == 0 for words in _words(own).values())


def test_many_options_are_spread_in_bounded_time() -> None:
    """Far more words than an experiment has: few sequences are followed, and they are as fair."""
    options = np.array(list(itertools.product(range(4), range(6), range(12), range(10))), dtype=np.int64)
    chosen = options[spread(np.random.default_rng(1), options, 60)]
    assert all(np.ptp(np.bincount(column)) <= 1 for column in chosen.T)
