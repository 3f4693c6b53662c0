"""Whether the shades of a color are categories of their own, on states made by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from data_collection.simulation_settings import Simulation
from evaluation.claims.shades import Shade, apart, is_figure_8, shades_of
from features.table import FeatureTable
from model import Fit
from tests.conftest import simulation_of

# Of each object its word, color and category: two shades of red, of which cups have the dark one.
OBJECTS = [
    *[("ball", "red", 0)] * 3,
    ("ball", "red", 2),
    *[("cup", "red", 1)] * 4,
    ("cup", "blue", 1),
    *[("cup", "blue", 2)] * 3,
]
SHADES = {("ball", "red"): 0, ("cup", "red"): 1, ("cup", "blue"): 0}


def _of(table: FeatureTable, fit: Fit, objects: list[tuple[str, str, int]], says: dict[int, str]) -> Any:
    """A table and a fit of these objects, whose color categories say these words."""
    table = replace(
        table, truth_object=tuple(one[0] for one in objects), truth_color=tuple(one[1] for one in objects)
    )
    c = fit.trials.index_of("color")
    log_words = np.full_like(fit.state.log_words[c], -5.0)
    for k, word in says.items():
        log_words[k, fit.trials.vocabulary.index(word)] = -0.1
    z = [np.array([one[2] for one in objects]) if i == c else own for i, own in enumerate(fit.state.z)]
    words = [log_words if i == c else own for i, own in enumerate(fit.state.log_words)]
    return table, replace(fit, state=replace(fit.state, z=tuple(z), log_words=tuple(words)))


@pytest.fixture
def words(proposed: Fit) -> tuple[str, str]:
    """Two words that were heard, in the part of “red” and “blue”."""
    red, blue, *_ = proposed.trials.vocabulary
    return red, blue


def _found(table: FeatureTable, fit: Fit, words: tuple[str, str], *, changes: Any = None, says: Any = None) -> Any:
    red, blue = words
    named = {"red": red, "blue": blue}
    objects = [(what, named[color], k) for what, color, k in {**dict(enumerate(OBJECTS)), **(changes or {})}.values()]
    told = {0: "red", 1: "red", 2: "blue"} | (says or {})
    own = _of(table, fit, objects, {k: named[word] for k, word in told.items()})
    return shades_of(own[1], own[0], {(what, named[color]): one for (what, color), one in SHADES.items()}, red)


def test_the_category_of_each_shade(table: FeatureTable, proposed: Fit, words: tuple[str, str]) -> None:
    found = _found(table, proposed, words)
    red = words[0]
    assert found == [Shade(red, 0, 4, 1, 0.75, 1.0, red), Shade(red, 1, 4, 2, 1.0, 0.8, red)]
    assert apart(found) == 1.0


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (dict.fromkeys(range(4, 8), ("cup", "red", 0)), {}),  # both shades in one category
        ({i: ("ball", "red", i) for i in range(3)}, {}),  # one shade is scattered
        (dict.fromkeys(range(8, 12), ("cup", "blue", 1)), {}),  # half of the category is of another color
        ({}, {1: "blue"}),  # says another word
        ({}, {0: "blue"}),
    ],
)
def test_not_apart(
    table: FeatureTable, proposed: Fit, words: tuple[str, str], changes: dict[int, Any], says: dict[int, str]
) -> None:
    assert apart(_found(table, proposed, words, changes=changes, says=says)) == 0.0


def test_a_single_shade_says_nothing(table: FeatureTable, proposed: Fit, words: tuple[str, str]) -> None:
    found = _found(table, proposed, words, changes=dict.fromkeys(range(8), ("ball", "red", 0)))
    assert [one.shade for one in found] == [0]
    assert apart(found) is None
    assert shades_of(proposed, replace(table, truth_object=None, truth_color=None), SHADES, words[0]) == []


def test_words_tell_the_shade_of_the_studys_objects() -> None:
    told = simulation_of("real").shades_by_words()
    assert len(told) == 14
    assert {(what, shade) for what, color, shade in told if color == "green"} == {
        ("car", 1),
        ("cup", 0),
        ("ball", 1),
        ("star", 0),
    }


def test_words_of_several_shades_tell_none() -> None:
    cups = [{"object": "cup", "color": "red", "shape": "cup", "shade": shade} for shade in (0, 1)]
    ball = {"object": "ball", "color": "red", "shape": "ball", "shade": 1}
    shades = [[0.9, 0.1, 0.1], [0.4, 0.1, 0.1]]
    simulation = Simulation.model_validate({"colors": {"red": shades}, "objects": [*cups, ball]})
    assert simulation.shades_by_words() == [("ball", "red", 1)]


def test_the_condition_of_figure_8() -> None:
    condition = {"experiment": "real", "variant": "few", "method": "proposed", "D": 25, "ROW": 9}
    assert is_figure_8({**condition, "sampler": "mixing", "dataset": 3})
    for key, value in (("variant", "default"), ("D", 40), ("ROW", 0), ("method", "mmlda"), ("experiment", "own")):
        assert not is_figure_8({**condition, key: value})
