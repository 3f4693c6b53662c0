"""What is done and said in a trial: scene, action, tutor's words. Pure functions of a random generator."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from data_collection.apparatus import Motion, ObjectKind, Tutor
from data_collection.shapes import build
from data_collection.simulation_settings import ACTION, COLOR, OBJECT, POSITION, Simulation

_TRIES = 2000


@dataclass(frozen=True)
class Placed:
    """An object on the table.

    Attributes:
        kind: What it is.
        place: Word of the place that it was drawn at.
        position: x and y of its centre, metres, robot frame.
        turn: Angle about the vertical, radians.
    """

    kind: ObjectKind
    place: str
    position: tuple[float, float]
    turn: float


@dataclass(frozen=True)
class Plan:
    """What the robot will do.

    Attributes:
        attended: Index of the object that it looks at.
        moves: Whether the hand goes out.
        offset: Of the hand's target from the best grasp of the attended object, metres.
        finger_rate: Bend of the five fingers, 0 open .. 1 closed.
    """

    attended: int
    moves: bool
    offset: tuple[float, float, float]
    finger_rate: float


@dataclass(frozen=True)
class Command:
    """An action that somebody asks for, in the scene of an instruction.

    Attributes:
        trial: Number of the instruction.
        gaze: x and y of the place to look at, metres, robot frame: the object nearest to it is acted on.
        target: x, y and z of where to bring the grasp point, metres, robot frame; None leaves the hand at rest.
        finger_rate: Bend of the five fingers, 0 open .. 1 closed.
    """

    trial: int
    gaze: tuple[float, float]
    target: tuple[float, float, float] | None
    finger_rate: float

    def __post_init__(self) -> None:
        """Refuse what is none, for commands are read from logs, too.

        Raises:
            ValueError: A number is missing, not finite, or out of its range.
        """
        wanted = ((self.gaze, 2), ((0.0,) * 3 if self.target is None else self.target, 3))
        if any(np.shape(place) != (size,) or not np.isfinite(place).all() for place, size in wanted):
            raise ValueError(f"gaze {self.gaze!r}, target {self.target!r}: two and three numbers are expected")
        if self.trial < 1 or not 0.0 <= self.finger_rate <= 1.0:
            raise ValueError(f"trial {self.trial!r}, finger_rate {self.finger_rate!r}: from 1, 0 to 1 are expected")

    def nearest(self, placed: Sequence[Placed]) -> int:
        """Return the index of the object that is nearest to the gaze."""
        return min(range(len(placed)), key=lambda i: math.dist(self.gaze, placed[i].position))


@dataclass(frozen=True)
class Outcome:
    """What was measured of an action, for the tutor and the logs; no feature is made of it.

    Attributes:
        displacement: Of the hand from its rest position at the end of the action, metres.
        force: Sum of the forces between the hand and the attended object at the end of the action, newtons.
        finger_rate: Commanded bend of the fingers, 0..1.
        rise: Height that the object gained in the lift test, metres; 0 where the hand was not lifted.
        hand_error: Distance of the hand from its commanded target, metres; None when it was not sent anywhere.
        toppled: Indices of objects, other than the attended one, that action or lift moved by over 2 cm or tilted by
            over 30°.
    """

    displacement: float
    force: float
    finger_rate: float
    rise: float
    hand_error: float | None
    toppled: tuple[int, ...]


def draw_scene(rng: np.random.Generator, simulation: Simulation) -> tuple[Placed, ...]:
    """Draw the objects of a trial: different ones at different places, apart from each other, in reach and view."""
    count = int(rng.integers(simulation.objects_least, simulation.objects_most + 1))
    kinds = simulation.kinds()
    chosen = [kinds[index] for index in rng.permutation(len(kinds))[:count]]
    places = [str(place) for place in rng.permutation(list(simulation.places))[:count]]
    return arrange(rng, simulation, chosen, places)


def arrange(
    rng: np.random.Generator, simulation: Simulation, kinds: Sequence[ObjectKind], places: Sequence[str]
) -> tuple[Placed, ...]:
    """Draw positions for objects at given places.

    Raises:
        ValueError: No arrangement without contact was found: the places are too close for the objects.
    """
    spread = simulation.place_spread
    for _ in range(_TRIES):
        placed: list[Placed] = []
        for kind, place in zip(kinds, places, strict=True):
            shift = rng.normal(size=2)
            turn = math.radians(simulation.turn) * float(rng.uniform(-1.0, 1.0))
            x, y = np.array(simulation.places[place]) + spread * shift
            if np.hypot(*shift) <= simulation.place_cut:
                placed.append(Placed(kind, place, (float(x), float(y)), turn))
        if len(placed) == len(kinds) and _apart(placed, simulation.gap) and _on_table(placed, simulation):
            return tuple(placed)
    raise ValueError(f"simulation.places: no room for {len(kinds)} objects at {list(places)} without contact")


def draw_plan(rng: np.random.Generator, simulation: Simulation, objects: int) -> Plan:
    """Draw which object is attended, whether the hand moves, where to, and how far the fingers bend."""
    attended = int(rng.integers(objects))
    moves = bool(rng.random() >= simulation.motion.look_share)
    offset = draw_offset(rng, simulation.motion)
    rate = float(rng.random())
    return Plan(attended, moves, offset if moves else (0.0, 0.0, 0.0), rate if moves else 0.0)


def draw_offset(rng: np.random.Generator, motion: Motion) -> tuple[float, float, float]:
    """Draw the hand's target relative to the best grasp, metres."""
    x, y, z = rng.normal(size=3)
    height = max(motion.height_mean + motion.height_spread * z, motion.height_least)
    return float(motion.target_spread * x), float(motion.target_spread * y), float(height)


@dataclass(frozen=True)
class Judgement:
    """What the tutor makes of an outcome.

    Attributes:
        contact: Whether the hand touched the attended object at the end of the action.
        held: Whether the object stayed in the hand in the lift test.
        action: Which of the four actions it was.
    """

    contact: bool
    held: bool
    action: str


def touches(force: float, tutor: Tutor) -> bool:
    """Return whether a force between hand and object, newtons, is a touch to the tutor."""
    return force >= tutor.contact


def judge(outcome: Outcome, simulation: Simulation) -> Judgement:
    """Return what the tutor sees (section 4.2.1 of the paper)."""
    tutor = simulation.tutor
    contact = touches(outcome.force, tutor)
    held = outcome.rise >= tutor.held * simulation.motion.lift_height
    if outcome.displacement < tutor.moved:
        action = "look-at"
    elif held and outcome.finger_rate >= tutor.bend:
        action = "grasp"
    else:
        action = "touch" if contact else "reach"
    return Judgement(contact, held, action)


def channel_words(simulation: Simulation, action: str, placed: Placed) -> dict[str, str]:
    """Return the word of each channel for an action on an object."""
    return {
        ACTION: simulation.actions[action],
        POSITION: placed.place,
        OBJECT: placed.kind.object,
        COLOR: placed.kind.color,
    }


def utter(rng: np.random.Generator, words: dict[str, str]) -> tuple[str, ...]:
    """Return the words in random order."""
    said = list(words.values())
    return tuple(said[index] for index in rng.permutation(len(said)))


def describe(scene: Sequence[Placed]) -> list[dict[str, object]]:
    """Return the objects as plain values for the truth topic."""
    return [
        {**item.kind.model_dump(), "place": item.place, "position": list(item.position), "turn": item.turn}
        for item in scene
    ]


def _apart(placed: Sequence[Placed], gap: float) -> bool:
    radii = [build(item.kind.shape, item.kind.size, item.kind.height, item.kind.style).radius for item in placed]
    return all(
        math.dist(first.position, second.position) >= radii[i] + radii[i + 1 + j] + gap
        for i, first in enumerate(placed)
        for j, second in enumerate(placed[i + 1 :])
    )


def _on_table(placed: Sequence[Placed], simulation: Simulation) -> bool:
    return all(item.position[0] - simulation.table.near >= item.kind.size / 2 + 0.005 for item in placed)
