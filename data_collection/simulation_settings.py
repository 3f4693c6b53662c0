"""Every level of a simulated experiment: words, objects, camera, noise, motion and the tutor's thresholds.

`Simulation` is the section `simulation:` of an experiment in the config. Lengths in metres in the robot frame (x
ahead, y left), angles in degrees where named so, forces in newtons, times in seconds, colors 0..1.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeAlias

from pydantic import Field, ValidationInfo, field_validator, model_validator

from data_collection.apparatus import Camera, Hand, Light, Motion, Noise, ObjectKind, Table, Tutor
from data_collection.strict_model import LISTED, Color, Point, StrictModel, Word

ACTIONS = ("reach", "touch", "grasp", "look-at")
"""The physical outcomes that the tutor tells apart."""
if TYPE_CHECKING:
    Action: TypeAlias = str
else:
    Action = Literal[ACTIONS]
ACTION, POSITION, OBJECT, COLOR = "action", "position", "object", "color"

_DEFAULT_SIZES = {"box": 0.044, "cup": 0.052, "ball": 0.054}


class Simulation(StrictModel):
    """The simulated robot, table, objects and tutor; every key has a default."""

    actions: dict[Action, Word] = Field(
        {}, validate_default=True, description="physical outcome → word that the tutor says"
    )
    places: dict[Word, Point] = Field(
        {"far": (0.36, 0.0), "front": (0.21, 0.0), "left": (0.285, 0.16), "right": (0.285, -0.16)},
        min_length=1,
        description="word → middle of the place, metres ahead and to the left, robot frame",
    )
    colors: dict[Word, Annotated[tuple[Color, ...], Field(min_length=1), LISTED]] = Field(
        {"blue": ((0.10, 0.20, 0.85),), "green": ((0.10, 0.65, 0.15),), "red": ((0.85, 0.10, 0.10),)},
        min_length=1,
        description="word → its shades, each red, green, blue in 0..1",
    )
    objects: Annotated[tuple[ObjectKind, ...], LISTED] = Field(
        (),
        description="objects that may stand on the table; empty: box, cup and ball in the first shade of each color",
    )
    objects_least: int = Field(1, description="fewest objects in a trial", ge=1, le=10)
    objects_most: int = Field(3, description="most objects in a trial; not more than there are places", ge=1, le=10)
    place_spread: float = Field(
        0.028, description="standard deviation of a position about its place, metres", ge=0.0, le=0.1
    )
    place_cut: float = Field(
        2.1, description="positions farther than so many standard deviations are drawn again", ge=0.5, le=4.0
    )
    gap: float = Field(0.012, description="least distance between two objects, metres", ge=0.0, le=0.1)
    turn: float = Field(
        180.0,
        description="objects are turned about the vertical by up to so many degrees either way",
        ge=0.0,
        le=180.0,
    )
    table: Table = Table()
    light: Light = Light()
    camera: Camera = Camera()
    noise: Noise = Noise()
    motion: Motion = Motion()
    hand: Hand = Hand()
    tutor: Tutor = Tutor()

    @field_validator("actions", "places", "colors")
    @classmethod
    def _in_order(cls, words: dict[str, Any], info: ValidationInfo) -> dict[str, Any]:
        """Put words into alphabetical order, so that the order of keys in a config changes no draw."""
        defaults = {action: action for action in ACTIONS} if info.field_name == "actions" else {}
        return dict(sorted((defaults | words).items()))

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if problems := list(self._problems()):
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        """What does not fit together, each with its key."""
        most, kinds = self.objects_most, self.kinds()
        if self.objects_least > most:
            yield f"objects_least: {self.objects_least} is more than objects_most ({most})"
        if most > len(self.places):
            yield f"objects_most: {most} objects need as many places, there are {len(self.places)}"
        if most > len(kinds):
            yield f"objects_most: {most} is more than there are objects ({len(kinds)})"
        for number, kind in enumerate(self.objects):
            where, shades = f"objects[{number}]", self.colors.get(kind.color)
            if shades is None:
                yield f"{where}.color: {kind.color!r} is unknown (allowed: {', '.join(self.colors)})"
            elif kind.shade >= len(shades):
                yield f"{where}.shade: {kind.color!r} has only {len(shades)} shades, counted from 0"
            if kind in self.objects[:number]:
                yield f"{where}: the same as objects[{self.objects.index(kind)}]; each may be listed once"
        nearest = self.table.near + 0.05
        for word, (x, y) in self.places.items():
            if not (nearest <= x <= 0.42 and abs(y) <= 0.22):
                yield (
                    f"places.{word}: [{x}, {y}] is out of view or reach "
                    f"(allowed: x from {nearest:.2f} to 0.42 m, y from -0.22 to 0.22 m)"
                )
        words = list(self.actions.values())
        for word in sorted({word for word in words if words.count(word) > 1}):
            yield f"actions: the word {word!r} stands for two outcomes"

    def kinds(self) -> tuple[ObjectKind, ...]:
        """Return the objects, or the default ones."""
        if self.objects:
            return self.objects
        return tuple(
            ObjectKind(object=shape, color=color, shape=shape, size=size)
            for shape, size in _DEFAULT_SIZES.items()
            for color in self.colors
        )

    def shades_by_words(self) -> list[tuple[str, str, int]]:
        """Return object word, color word and shade of the objects, where the words tell the shade."""
        told = {(kind.object, kind.color, kind.shade) for kind in self.kinds()}
        words = [(what, color) for what, color, _ in told]
        return sorted(one for one in told if words.count(one[:2]) == 1)

    def check_words(self, words: Mapping[str, Sequence[str]]) -> list[str]:
        """Return every disagreement with the words of the experiment, `{action, position, object, color}`."""
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
