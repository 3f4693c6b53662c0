"""What is drawn in trials of test sets: scenes around what each is about, and actions for the word that is due."""

import numpy as np

from data_collection.apparatus import ObjectKind
from data_collection.design import Target, target
from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation
from data_collection.task import Placed, Plan, arrange, draw_offset

MOST_ATTEMPTS = 300
"""So often a trial is tried until the tutor says the word that is due."""


def target_of(simulation: Simulation, names: tuple[str, str, int], seed: int) -> Target:
    """Return what a trial of a test set is about; `names` are experiment, set and trial."""
    experiment, set_name, trial = names
    return target(simulation, experiment=experiment, set_name=set_name, trial=trial, seed=seed)


def draw_instruction(
    simulation: Simulation, names: tuple[str, str, int], seed: int
) -> tuple[tuple[Placed, ...], int, str]:
    """Draw the scene of an instruction.

    Args:
        simulation: Settings of the experiment.
        names: Experiment, set and trial.
        seed: Seed of the study.

    Returns:
        The objects, the index of the instructed one, and the action that is asked for.
    """
    due = target_of(simulation, names, seed)
    rng = generator(seed, "collect", *names, "scene")
    return *draw_choice(rng, simulation, due.kind, due.place), due.action


def draw_choice(
    rng: np.random.Generator, simulation: Simulation, chosen: ObjectKind, place: str
) -> tuple[tuple[Placed, ...], int]:
    """Draw a scene of two or three objects of which one is `chosen` at `place`; return it and the index of that one.

    At least one other object shares its word of the color or of the object channel where the experiment has
    such objects; none shares both, so exactly one fits.
    """
    others = [kind for kind in simulation.kinds() if (kind.object, kind.color) != (chosen.object, chosen.color)]
    similar = [kind for kind in others if kind.color == chosen.color or kind.object == chosen.object]
    count = min(int(rng.integers(2, 4)), len(others) + 1, len(simulation.places))
    pool = similar or others
    kinds = [chosen]
    if count > 1:
        kinds.append(pool[int(rng.integers(len(pool)))])
    rest = [kind for kind in others if kind not in kinds]
    kinds += [rest[index] for index in rng.permutation(len(rest))[: count - len(kinds)]]
    return _arranged(rng, simulation, kinds, place)


def draw_scene_with(
    rng: np.random.Generator, simulation: Simulation, attended: ObjectKind, place: str
) -> tuple[tuple[Placed, ...], int]:
    """Draw a scene as of a training trial, given what is attended and where; return it and the index of that one."""
    count = int(rng.integers(simulation.objects_least, simulation.objects_most + 1))
    others = [kind for kind in simulation.kinds() if kind != attended]
    kinds = [attended, *(others[index] for index in rng.permutation(len(others))[: count - 1])]
    return _arranged(rng, simulation, kinds, place)


def draw_plan_for(rng: np.random.Generator, simulation: Simulation, attended: int, action: str) -> Plan:
    """Draw an action as in a training trial, given that the tutor may call it `action`.

    The hand moves unless the robot is to look only, and the fingers bend as far as the tutor's *grasp* asks for. What
    comes of it is left to the physics.
    """
    if action == "look-at":
        return Plan(attended, moves=False, offset=(0.0, 0.0, 0.0), finger_rate=0.0)
    least = simulation.tutor.bend if action == "grasp" else 0.0
    offset = draw_offset(rng, simulation.motion)
    return Plan(attended, moves=True, offset=offset, finger_rate=least + (1.0 - least) * float(rng.random()))


def never_said(due: Target, names: tuple[str, str, int], simulation: Simulation) -> str:
    """Return the message for a word that the tutor does not say, whatever is tried."""
    experiment, set_name, trial = names
    what = f"{due.kind.color} {due.kind.object} at {due.place!r}"
    return (
        f"{experiment}, {set_name}, trial {trial}: the tutor did not say {simulation.actions[due.action]!r} "
        f"({due.action}) in {MOST_ATTEMPTS} attempts with a {what}, and a fair test set needs it; see what "
        "rules it out: simulation.tutor (moved, contact, bend, held), simulation.motion (height_mean, height_spread, "
        "target_spread), or the object's size and height"
    )


def _arranged(
    rng: np.random.Generator, simulation: Simulation, kinds: list[ObjectKind], place: str
) -> tuple[tuple[Placed, ...], int]:
    """Put the first kind at a place, the rest at others; return the objects shuffled, and the index of the first."""
    free = [name for name in simulation.places if name != place]
    places = [place, *(str(name) for name in rng.permutation(free)[: len(kinds) - 1])]
    scene = arrange(rng, simulation, kinds, places)
    order = [int(index) for index in rng.permutation(len(kinds))]
    return tuple(scene[index] for index in order), order.index(0)
