# ruff: noqa: RUF009 — `setting` is `dataclasses.field` with a documentation and a range
"""Every level of a simulated experiment: words, objects, camera, noise, motion and the tutor's thresholds.

``Simulation`` is the section ``simulation:`` of an experiment in the config. Lengths in metres in the robot frame (x
ahead, y left), angles in degrees where named so, forces in newtons, times in seconds, colors 0..1.
"""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from data_collection.apparatus import (
    RGB,
    Camera,
    Color,
    Hand,
    Light,
    Motion,
    Noise,
    ObjectKind,
    Table,
    Tutor,
)
from data_collection.limits import WORD_PATTERN
from data_collection.schema import build, mismatches, setting

ACTIONS = ("reach", "touch", "grasp", "look-at")
"""The physical outcomes that the tutor tells apart."""
ACTION, POSITION, OBJECT, COLOR = "action", "position", "object", "color"

_DEFAULT_SIZES = {"box": 0.044, "cup": 0.052, "ball": 0.054}

_POINT: dict[str, Any] = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
_NAME: dict[str, Any] = {"pattern": WORD_PATTERN}


def _colors() -> dict[str, tuple[Color, ...]]:
    return {"green": ((0.10, 0.65, 0.15),), "red": ((0.85, 0.10, 0.10),), "blue": ((0.10, 0.20, 0.85),)}


def _places() -> dict[str, tuple[float, float]]:
    return {"front": (0.21, 0.0), "left": (0.285, 0.16), "right": (0.285, -0.16), "far": (0.36, 0.0)}


def _actions() -> dict[str, str]:
    return {action: action for action in ACTIONS}


@dataclass(frozen=True)
class Simulation:
    """An experiment in simulation.

    An empty ``objects`` stands for box, cup and ball in the first shade of each color.
    """

    actions: Mapping[str, str] = setting(
        factory=_actions,
        doc="physical outcome → word that the tutor says",
        type="object",
        properties={
            name: {"type": "string", "pattern": WORD_PATTERN, "default": name, "description": f"word for {name}"}
            for name in ACTIONS
        },
        additionalProperties=False,
    )
    places: Mapping[str, tuple[float, float]] = setting(
        factory=_places,
        doc="word → middle of the place, metres ahead and to the left, robot frame",
        type="object",
        propertyNames=_NAME,
        additionalProperties=_POINT,
        minProperties=1,
    )
    colors: Mapping[str, tuple[Color, ...]] = setting(
        factory=_colors,
        doc="word → its shades, each red, green, blue in 0..1",
        type="object",
        propertyNames=_NAME,
        additionalProperties={"type": "array", "items": RGB, "minItems": 1},
        minProperties=1,
    )
    objects: tuple[ObjectKind, ...] = setting((), entries=ObjectKind, doc="objects that may stand on the table")
    objects_least: int = setting(1, doc="fewest objects in a trial", low=1, high=10)
    objects_most: int = setting(3, doc="most objects in a trial; not more than there are places", low=1, high=10)
    place_spread: float = setting(
        0.028, doc="standard deviation of a position about its place, metres", low=0.0, high=0.1
    )
    place_cut: float = setting(
        2.1, doc="positions farther than so many standard deviations are drawn again", low=0.5, high=4.0
    )
    gap: float = setting(0.012, doc="least distance between two objects, metres", low=0.0, high=0.1)
    turn: float = setting(
        180.0, doc="objects are turned about the vertical by up to so many degrees either way", low=0.0, high=180.0
    )
    table: Table = setting(Table(), doc="the table")
    light: Light = setting(Light(), doc="the light")
    camera: Camera = setting(Camera(), doc="the camera")
    noise: Noise = setting(Noise(), doc="noise of the senses")
    motion: Motion = setting(Motion(), doc="motion")
    hand: Hand = setting(Hand(), doc="the hand")
    tutor: Tutor = setting(Tutor(), doc="the tutor's thresholds")

    def __post_init__(self) -> None:
        """Put words into alphabetical order, so that the order of keys in a config changes no draw."""
        object.__setattr__(self, "actions", _actions() | dict(self.actions))
        for name in ("actions", "places", "colors"):
            object.__setattr__(self, name, dict(sorted(getattr(self, name).items())))

    @classmethod
    def from_mapping(cls, mapping: Mapping[str, Any]) -> "Simulation":
        """Return the settings that a section of the config describes; absent keys take their defaults.

        Raises:
            ValueError: Lists every mismatch with its key path and what is allowed.
        """
        found = mismatches(cls, mapping, "simulation")
        if not found:
            simulation = build(cls, mapping)
            found = simulation.problems()
            if not found:
                return simulation
        raise ValueError("\n".join(found))

    def problems(self) -> list[str]:
        """Return what does not fit together, each with its key path."""
        found = []
        most = self.objects_most
        if self.objects_least > most:
            found.append(f"simulation.objects_least: {self.objects_least} is more than objects_most ({most})")
        if most > len(self.places):
            found.append(f"simulation.objects_most: {most} objects need as many places, there are {len(self.places)}")
        if most > len(self.kinds()):
            found.append(f"simulation.objects_most: {most} is more than there are objects ({len(self.kinds())})")
        for number, kind in enumerate(self.objects):
            where = f"simulation.objects[{number}]"
            if kind.color not in self.colors:
                found.append(f"{where}.color: {kind.color!r} is none of the colors {sorted(self.colors)}")
            elif kind.shade >= len(self.colors[kind.color]):
                found.append(
                    f"{where}.shade: {kind.color!r} has only {len(self.colors[kind.color])} shades, counted from 0"
                )
            if kind in self.objects[:number]:
                found.append(f"{where}: the same as objects[{self.objects.index(kind)}]; each may be listed once")
        for word, (x, y) in self.places.items():
            if not (self.table.near + 0.05 <= x <= 0.42 and abs(y) <= 0.22):
                found.append(
                    f"simulation.places.{word}: [{x}, {y}] is out of view or reach; "
                    f"x from {self.table.near + 0.05:.2f} to 0.42 m and y from -0.22 to 0.22 m are allowed"
                )
        words = list(self.actions.values())
        found.extend(
            f"simulation.actions: the word {word!r} stands for two outcomes"
            for word in set(words)
            if words.count(word) > 1
        )
        return found

    def kinds(self) -> tuple[ObjectKind, ...]:
        """Return the objects, or the default ones."""
        if self.objects:
            return self.objects
        return tuple(
            ObjectKind(shape, color, shape, size=size)
            for shape, size in _DEFAULT_SIZES.items()
            for color in self.colors
        )

    def check_words(self, words: Mapping[str, Sequence[str]]) -> list[str]:
        """Return every disagreement with the words of the experiment, ``{action, position, object, color}``."""
        said = {
            ACTION: set(self.actions.values()),
            POSITION: set(self.places),
            OBJECT: {kind.object for kind in self.kinds()},
            COLOR: {kind.color for kind in self.kinds()},
        }
        found = []
        for channel, mine in said.items():
            listed = set(words.get(channel, ()))
            if mine - listed:
                found.append(f"words.{channel}: the simulation says {sorted(mine - listed)}, which is not listed")
            if listed - mine:
                found.append(f"words.{channel}: {sorted(listed - mine)} can never be said by the simulation")
        found.extend(
            f"words: {word!r} is in {first} and in {second}"
            for first in said
            for second in said
            if first < second
            for word in sorted(said[first] & said[second])
        )
        return found

    def to_json(self) -> str:
        """Return all settings as canonical JSON, defaults included."""
        return json.dumps(dataclasses.asdict(self), sort_keys=True, separators=(",", ":"))
