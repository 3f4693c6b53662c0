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

from data_collection.limits import WORD_PATTERN
from data_collection.schema import build, mismatches, setting
from data_collection.shapes import BUILDERS

ACTIONS = ("reach", "touch", "grasp", "look-at")
"""The physical outcomes that the tutor tells apart."""
ACTION, POSITION, OBJECT, COLOR = "action", "position", "object", "color"

_DEFAULT_SIZES = {"box": 0.044, "cup": 0.052, "ball": 0.054}

Color = tuple[float, float, float]

_POINT: dict[str, Any] = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
_VECTOR: dict[str, Any] = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
_RGB: dict[str, Any] = {**_VECTOR, "items": {"type": "number", "minimum": 0, "maximum": 1}}
_NAME: dict[str, Any] = {"pattern": WORD_PATTERN}


@dataclass(frozen=True)
class ObjectKind:
    """One object that may stand on the table."""

    object: str = setting(doc="word of the object channel", pattern=WORD_PATTERN)
    color: str = setting(doc="word of the color channel, a key of `colors`", pattern=WORD_PATTERN)
    shape: str = setting(doc="mesh", enum=list(BUILDERS))
    size: float = setting(0.056, doc="largest horizontal size, metres", low=0.03, high=0.09)
    height: float = setting(0.056, doc="height, metres (a ball is as high as wide)", low=0.02, high=0.09)
    style: int = setting(0, doc="variant of the mesh (car 0..3, cup 0..2, star 0..1)", low=0, high=3)
    shade: int = setting(0, doc="which shade of its color it has, counted from 0", low=0)
    mass: float = setting(0.06, doc="kilograms", low=0.005, high=1.0)


@dataclass(frozen=True)
class Table:
    """The table."""

    height: float = setting(-0.06, doc="height of its top, metres, robot frame", low=-0.15, high=0.05)
    near: float = setting(0.13, doc="x of its near edge, metres", low=0.1, high=0.2)
    far: float = setting(0.75, doc="x of its far edge, metres", low=0.5, high=1.5)
    width: float = setting(1.1, doc="width, metres", low=0.6, high=2.0)
    color: Color = setting((0.95, 0.95, 0.94), doc="red, green, blue, 0..1", **_RGB)
    cloth: float = setting(0.0, doc="strength of a woven texture, 0 none", low=0.0, high=1.0)


@dataclass(frozen=True)
class Light:
    """One lamp, and how it varies from trial to trial."""

    direction: Color = setting((0.3, 0.7, 2.0), doc="from the table to the lamp", **_VECTOR)
    ambient: float = setting(0.62, doc="share of light from everywhere", low=0.0, high=1.0)
    diffuse: float = setting(0.38, doc="share of light from the lamp", low=0.0, high=1.0)
    shadow: bool = setting(True, doc="whether things cast shadows")
    direction_spread: float = setting(
        0.0, doc="standard deviation of each number of the direction", low=0.0, high=1.0
    )
    brightness_spread: float = setting(
        0.0, doc="standard deviation of a factor on ambient and diffuse", low=0.0, high=0.3
    )


@dataclass(frozen=True)
class Camera:
    """The camera in the left eye."""

    width: int = setting(400, doc="columns", low=160, high=1280)
    height: int = setting(300, doc="rows", low=120, high=960)
    view: float = setting(64.0, doc="vertical angle of view, degrees", low=30.0, high=90.0)
    noise: float = setting(0.0, doc="standard deviation of a pixel's noise, grey levels of 255", low=0.0, high=30.0)
    blur: float = setting(0.0, doc="standard deviation of the blur, pixels", low=0.0, high=3.0)
    calibration_error: float = setting(
        0.0, doc="standard deviation of relative errors of the logged focal lengths and centre", low=0.0, high=0.05
    )
    mark_error: float = setting(
        0.0, doc="standard deviation of the measured positions of the calibration dots, metres", low=0.0, high=0.01
    )


@dataclass(frozen=True)
class Noise:
    """Noise of the robot's own senses."""

    joints: float = setting(0.0, doc="standard deviation of the joint encoders, degrees", low=0.0, high=5.0)
    gaze: float = setting(
        0.005, doc="standard deviation of the fixation point along x and y, metres", low=0.0, high=0.03
    )
    tactile: float = setting(0.0, doc="standard deviation of the touch sensors, of their range", low=0.0, high=0.3)


@dataclass(frozen=True)
class Motion:
    """How an action is drawn and carried out."""

    look_share: float = setting(0.20, doc="probability that the robot only looks", low=0.0, high=1.0)
    target_spread: float = setting(
        0.010, doc="standard deviation of the hand's target along x and y, metres", low=0.0, high=0.05
    )
    height_mean: float = setting(
        0.006, doc="mean height of the hand's target above the best grasp, metres", low=-0.02, high=0.1
    )
    height_spread: float = setting(0.014, doc="its standard deviation, metres", low=0.0, high=0.05)
    height_least: float = setting(-0.008, doc="lowest height drawn, metres", low=-0.03, high=0.05)
    clearance: float = setting(
        0.10, doc="height over the target from which the hand comes down, metres", low=0.03, high=0.15
    )
    gaze_time: float = setting(0.5, doc="seconds for turning head and eyes", low=0.1, high=5.0)
    transfer_time: float = setting(0.9, doc="seconds from rest to above the target", low=0.3, high=5.0)
    descent_time: float = setting(0.7, doc="seconds from there to the target", low=0.3, high=5.0)
    bend_time: float = setting(0.7, doc="seconds for bending and holding the fingers", low=0.3, high=5.0)
    lift_time: float = setting(1.0, doc="seconds of the lift test", low=0.3, high=5.0)
    lift_height: float = setting(0.06, doc="metres of the lift test", low=0.02, high=0.1)
    log_rate: float = setting(20.0, doc="joint, touch and hand messages per second", low=1.0, high=240.0)


@dataclass(frozen=True)
class Hand:
    """Forces of the right hand."""

    finger_torque: float = setting(0.25, doc="largest torque of a finger joint, N·m", low=0.01, high=5.0)
    friction: float = setting(1.2, doc="Coulomb friction of hand and objects", low=0.1, high=3.0)
    saturation: float = setting(3.0, doc="force at which a touch sensor reads 1, newtons", low=0.1, high=50.0)


@dataclass(frozen=True)
class Tutor:
    """Thresholds by which the tutor names an action."""

    moved: float = setting(
        0.03, doc="below this distance from its rest position the hand did not move, metres", low=0.005, high=0.1
    )
    contact: float = setting(0.05, doc="force from which it counts as contact, newtons", low=0.0, high=5.0)
    bend: float = setting(
        0.25, doc="finger rate from which the fingers are closed rather than open", low=0.0, high=1.0
    )
    held: float = setting(0.5, doc="share of the lift by which the object must have risen", low=0.1, high=1.0)


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
        additionalProperties={"type": "array", "items": _RGB, "minItems": 1},
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
