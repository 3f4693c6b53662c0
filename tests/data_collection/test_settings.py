import copy
import json
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from data_collection.simulation_settings import Simulation

SCHEMA = Simulation.model_json_schema()
WORDS = {
    "action": ["reach", "touch", "grasp", "look-at"],
    "position": ["front", "left", "right", "far"],
    "object": ["box", "cup", "ball"],
    "color": ["green", "red", "blue"],
}
OWN: dict[str, Any] = {
    "actions": {"reach": "tends", "touch": "touche", "grasp": "saisis", "look-at": "regarde"},
    "places": {"devant": [0.21, 0], "loin": [0.36, 0.0]},
    "colors": {"vert": [[0, 1, 0], [0.0, 0.5, 0.0]]},
    "objects": [
        {"object": "voiture", "color": "vert", "shape": "car", "style": 2, "shade": 1},
        {"object": "tasse", "color": "vert", "shape": "cup", "size": 0.05},
    ],
    "objects_most": 2,
    "camera": {"noise": 3, "width": 400},
}


def _followed(schema: dict[str, Any]) -> dict[str, Any]:
    behind = SCHEMA["$defs"][schema["$ref"].removeprefix("#/$defs/")] if "$ref" in schema else {}
    return {**behind, **schema}


def _leaves(
    schema: dict[str, Any] = SCHEMA, path: tuple[str | int, ...] = ()
) -> list[tuple[tuple[str | int, ...], dict[str, Any]]]:
    found: list[tuple[tuple[str | int, ...], dict[str, Any]]] = []
    for key, entry in schema["properties"].items():
        known = _followed(entry)
        found.append(((*path, key), known))
        if "properties" in known:
            found += _leaves(known, (*path, key))
        if "properties" in (item := _followed(known.get("items", {}))):
            found += _leaves(item, (*path, key, 0))
    return found


def _full() -> dict[str, Any]:
    """Return a section with every key set."""
    section: dict[str, Any] = json.loads(Simulation.model_validate(OWN).to_json())
    return section


def _broken() -> list[tuple[str, dict[str, Any], str]]:
    """Return (name, section, words that the message must have) for every key broken in every way its type allows."""
    wrong: dict[str, list[Any]] = {
        "number": ["text", True, None, [1]],
        "integer": ["text", 1.5, True, None],
        "boolean": ["yes", 1, None],
        "string": [1, None, ["a"]],
        "array": ["text", 1, {}, None],
        "object": ["text", 1, [], None],
    }
    cases = []
    for path, entry in _leaves():
        values = list(wrong[entry.get("type", "string")])
        values += [entry["minimum"] - 1] if "minimum" in entry else []
        values += [entry["maximum"] + 1] if "maximum" in entry else []
        values += ["nonsense"] if "enum" in entry else []
        values += ["two words", ""] if "pattern" in entry else []
        values += [[0.1], [0.1] * 4] if entry.get("maxItems") == 3 else []
        for value in values:
            section = _full()
            target: Any = section
            for step in path[:-1]:
                target = target[step]
            target[path[-1]] = value
            name = ".".join(str(step) for step in path)
            cases.append((f"{name}={value!r}", section, name))
    return cases


def _refused(section: dict[str, Any]) -> list[str]:
    """Return where a section is refused, and why."""
    with pytest.raises(ValidationError) as caught:
        Simulation.model_validate(section)
    return [".".join(map(str, [*error["loc"], error["msg"]])) for error in caught.value.errors()]


@pytest.mark.parametrize(("section", "key"), [pytest.param(*case[1:], id=case[0]) for case in _broken()])
def test_every_key_is_checked(section: dict[str, Any], key: str) -> None:
    assert any(place.startswith(f"{key}.") for place in _refused(section)), _refused(section)


@pytest.mark.parametrize("path", [(), ("camera",), ("objects", 0), ("table",), ("motion",)])
def test_unknown_keys_are_named(path: tuple[str | int, ...]) -> None:
    section = _full()
    target: Any = section
    for step in path:
        target = target[step]
    target["lense"] = 1
    assert _refused(section) == [".".join(map(str, [*path, "lense.Extra inputs are not permitted"]))]


def test_all_mismatches_at_once() -> None:
    section = {"camera": {"noise": -1, "lense": 2}, "objects": [{"object": "a b"}], "places": {"front": [1]}}
    text = "\n".join(_refused(section))
    expected = ["camera.noise", "camera.lense", "objects.0.object", "objects.0.shape.Field required", "places.front"]
    assert all(part in text for part in expected), text


def test_what_does_not_fit_together_is_told_at_once() -> None:
    one = {"object": "cup", "color": "red", "shape": "cup", "shade": 2}
    with pytest.raises(ValueError, match="Value error") as caught:
        Simulation.model_validate({"objects": [one, one], "objects_least": 4})
    assert [key for key in ("objects_least: 4", "objects[0].shade", "objects[1]: ") if key in str(caught.value)] == [
        "objects_least: 4",
        "objects[0].shade",
        "objects[1]: ",
    ]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"objects_least": 3, "objects_most": 2}, "objects_least"),
        ({"objects_most": 5}, "as many places"),
        ({"objects": [{"object": "cup", "color": "mauve", "shape": "cup"}]}, r"objects\[0\].color.*mauve"),
        ({"objects": [{"object": "cup", "color": "red", "shape": "cup", "shade": 2}]}, r"objects\[0\].shade"),
        (
            {"objects": [{"object": "cup", "color": "red", "shape": "cup"}] * 2},
            r"objects\[1\]: the same as .*\[0\]",
        ),
        ({"places": {"a": [0.2, 0], "b": [0.3, 0], "c": [0.9, 0]}}, r"places.c.*out of view"),
        ({"actions": {"reach": "go", "touch": "go"}}, "'go' stands for two"),
    ],
)
def test_what_does_not_fit_together(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Simulation.model_validate(change)


def test_own_words_are_config_only() -> None:
    simulation = Simulation.model_validate(OWN)
    assert simulation.objects[0].style == 2
    assert simulation.camera.noise == 3.0
    assert isinstance(simulation.camera.noise, float)
    words = {
        "action": list(OWN["actions"].values()),
        "position": ["devant", "loin"],
        "object": ["tasse", "voiture"],
        "color": ["vert"],
    }
    assert simulation.check_words(words) == []


def test_words_of_the_defaults_are_the_papers() -> None:
    assert Simulation().check_words(WORDS) == []


@pytest.mark.parametrize("channel", list(WORDS))
def test_words_that_disagree(channel: str) -> None:
    more, less = copy.deepcopy(WORDS), copy.deepcopy(WORDS)
    more[channel].append("extra")
    dropped = less[channel].pop()
    assert any(channel in text and "extra" in text for text in Simulation().check_words(more))
    assert any(channel in text and dropped in text for text in Simulation().check_words(less))


def test_word_in_two_channels() -> None:
    simulation = Simulation.model_validate({"actions": {"reach": "left"}})
    words = {**WORDS, "action": ["left", "touch", "grasp", "look-at"]}
    assert any("'left'" in text for text in simulation.check_words(words))


def test_order_of_keys_is_nothing() -> None:
    places = {"front": [0.21, 0.0], "left": [0.285, 0.16], "far": [0.36, 0.0], "right": [0.285, -0.16]}
    backwards = dict(reversed(places.items()))
    one, other = (Simulation.model_validate({"places": each}) for each in (places, backwards))
    assert list(one.places) == list(other.places)
    assert one.to_json() == other.to_json()


def test_settings_survive_their_json() -> None:
    simulation = Simulation.model_validate(OWN)
    assert Simulation.model_validate(json.loads(simulation.to_json())) == simulation


def test_schema_describes_and_defaults_everything() -> None:
    for path, entry in _leaves():
        assert entry["description"], path
        required = path[0] == "objects" and path[-1] in ("object", "color", "shape")
        assert ("default" in entry) != required, path
        assert Draft202012Validator({"$defs": SCHEMA["$defs"], **entry}).is_valid(entry.get("default", "box")), path
