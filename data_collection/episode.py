"""Trials from beginning to end: scene, gaze, action, tutor, log."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from data_collection import task
from data_collection.joints import JOINT_NAMES, TACTILE_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Log, Message
from data_collection.log.messages import Floats, Value
from data_collection.seeding import generator
from data_collection.simulation_settings import ACTION, Simulation
from data_collection.simulator import scene
from data_collection.simulator.camera import believed, expose
from data_collection.simulator.recording import Recording
from data_collection.simulator.world import World

SETS = ("train", "generation", "description")
MARK_ROWS, MARK_COLUMNS, MARK_RADIUS = 5, 7, 0.006


def collect(
    simulation: Simulation,
    *,
    experiment: str,
    set_name: str,
    trials: Sequence[int],
    seed: int,
    provenance: Mapping[str, str],
) -> Iterator[Log]:
    """Simulate trials one after the other in one world.

    A trial depends on (seed, experiment, set, trial) alone, never on the trials before it.

    Args:
        simulation: Settings of the experiment.
        experiment: Its name.
        set_name: `train` or `description` (an action, and the tutor's sentence about it) or `generation` (a
            scene and an instruction that one object fits; no action).
        trials: Numbers from 1.
        seed: Seed of the study.
        provenance: Further metadata of the log, such as hashes of code and lock file.

    Raises:
        ValueError: Unknown set, or trial below 1.
    """
    if set_name not in SETS:
        raise ValueError(f"set {set_name!r} is none of {', '.join(SETS)}")
    if any(trial < 1 for trial in trials):
        raise ValueError("trials are counted from 1")
    with World(simulation) as world:
        for trial in trials:
            names = (experiment, set_name, trial)
            if set_name == "generation":
                yield _instruct(world, names, seed, provenance)
            else:
                yield _act(world, names, seed, provenance)


def execute(
    simulation: Simulation,
    *,
    experiment: str,
    seed: int,
    commands: Sequence[task.Command],
    provenance: Mapping[str, str],
    set_name: str = "generation",
) -> Iterator[Log]:
    """Carry out actions in the scenes of instructions, in one world; yield the log of what happened for each.

    Args:
        simulation: Settings of the experiment.
        experiment: Its name.
        seed: Seed of the study.
        commands: What to do in the scene of which instruction.
        provenance: Further metadata of the logs.
        set_name: Set of the scenes.
    """
    with World(simulation) as world:
        for command in commands:
            names = (experiment, set_name, command.trial)
            placed, _, words = _instruction(simulation, names, seed)
            attended = command.nearest(placed)
            world.set_up(placed, generator(seed, "collect", *names, "light"))
            target = None if command.target is None else np.array(command.target, dtype=np.float64)
            recording = _perform(world, names, seed, attended, target, command.finger_rate)
            said = task.utter(generator(seed, "collect", *names, "sentence"), words)
            noise = generator(seed, "collect", *names, "noise")
            told = {**provenance, "command": json.dumps(asdict(command), sort_keys=True)}
            yield _log(world, names, seed, told, placed, attended, recording, said, noise)


def calibrate(simulation: Simulation, *, experiment: str, seed: int, provenance: Mapping[str, str]) -> Log:
    """Take the pictures of the empty table and of a grid of dots on it, from the rest posture."""
    rng = generator(seed, "calibrate", experiment)
    camera = simulation.camera
    marks = mark_positions()
    with World(simulation) as world:
        world.set_up((), None)
        empty = expose(rng, world.picture(), camera)
        scene.add_marks(world.client, marks, simulation.table.height, MARK_RADIUS)
        dotted = expose(rng, world.picture(), camera)
    measured = marks + rng.normal(size=marks.shape) * camera.mark_error
    poses = np.column_stack(
        [measured, np.full(len(marks), simulation.table.height), np.zeros((len(marks), 3)), np.ones(len(marks))]
    )
    values: list[tuple[str, Value]] = [
        (topics.CAMERA, believed(generator(seed, "camera", experiment), camera)),
        (topics.CALIBRATION_EMPTY, empty),
        (topics.CALIBRATION_MARKS, dotted),
        (topics.CALIBRATION_POSITIONS, poses),
        (topics.CALIBRATION_PATTERN, json.dumps({"rows": MARK_ROWS, "columns": MARK_COLUMNS}, sort_keys=True)),
    ]
    metadata = _metadata(simulation, (experiment, "calibration", 0), seed, provenance)
    return Log(metadata, tuple(Message(topic, 0, value) for topic, value in values))


def mark_positions() -> Floats:
    """Return the true (35, 2) positions of the dots: rows from far to near, each from left to right."""
    ahead, left = np.linspace(0.42, 0.18, MARK_ROWS), np.linspace(0.21, -0.21, MARK_COLUMNS)
    return np.array([[x, y] for x in ahead for y in left])


def _act(world: World, names: tuple[str, str, int], seed: int, provenance: Mapping[str, str]) -> Log:
    simulation = world.simulation
    placed = task.draw_scene(generator(seed, "collect", *names, "scene"), simulation)
    plan = task.draw_plan(generator(seed, "collect", *names, "plan"), simulation, len(placed))
    world.set_up(placed, generator(seed, "collect", *names, "light"))
    target = None
    if plan.moves:
        target = world.best_grasp(plan.attended) + np.array(plan.offset)
        target[2] = max(target[2], world.lowest_grasp)
    recording = _perform(world, names, seed, plan.attended, target, plan.finger_rate)
    action = task.judge(recording.outcome, simulation).action
    words = task.channel_words(simulation, action, placed[plan.attended])
    said = task.utter(generator(seed, "collect", *names, "sentence"), words)
    noise = generator(seed, "collect", *names, "noise")
    return _log(world, names, seed, provenance, placed, plan.attended, recording, said, noise)


def _perform(
    world: World, names: tuple[str, str, int], seed: int, attended: int, target: Floats | None, rate: float
) -> Recording:
    """Act; the hand is lifted only from an object that it touches."""
    tutor = world.simulation.tutor
    offset = world.simulation.noise.gaze * generator(seed, "collect", *names, "gaze").normal(size=2)
    return world.act(attended, target, rate, offset, lifts=lambda force: task.touches(force, tutor))


def _instruct(world: World, names: tuple[str, str, int], seed: int, provenance: Mapping[str, str]) -> Log:
    simulation = world.simulation
    placed, attended, words = _instruction(simulation, names, seed)
    world.set_up(placed, generator(seed, "collect", *names, "light"))
    recording = world.rest()
    said = task.utter(generator(seed, "collect", *names, "sentence"), words)
    noise = generator(seed, "collect", *names, "noise")
    action = {word: outcome for outcome, word in simulation.actions.items()}[words[ACTION]]
    return _log(world, names, seed, provenance, placed, attended, recording, said, noise, action)


def _instruction(
    simulation: Simulation, names: tuple[str, str, int], seed: int
) -> tuple[tuple[task.Placed, ...], int, dict[str, str]]:
    """Return scene, index of the instructed object, and words; over consecutive trials every word takes its turn."""
    experiment, set_name, trial = names
    order = generator(seed, "collect", experiment, set_name, "order")
    kinds, places, actions = simulation.kinds(), list(simulation.places), list(simulation.actions)
    turns = [order.permutation(len(items)) for items in (kinds, places, actions)]
    kind = kinds[int(turns[0][(trial - 1) % len(kinds)])]
    place = places[int(turns[1][(trial - 1) % len(places)])]
    # Shifted by one each round, so that a place does not always come with the same action.
    action = actions[int(turns[2][(trial - 1 + (trial - 1) // len(actions)) % len(actions)])]
    placed, attended = task.draw_instruction(generator(seed, "collect", *names, "scene"), simulation, kind, place)
    return placed, attended, task.channel_words(simulation, action, placed[attended])


def _log(
    world: World,
    names: tuple[str, str, int],
    seed: int,
    provenance: Mapping[str, str],
    placed: Sequence[task.Placed],
    attended: int,
    recording: Recording,
    said: Sequence[str],
    noise: np.random.Generator,
    instructed: str | None = None,
) -> Log:
    simulation = world.simulation
    truth: dict[str, Any] = {"objects": task.describe(placed), "attended": attended}
    if instructed is None:
        judged = task.judge(recording.outcome, simulation)
        truth_outcome = vars(recording.outcome) | vars(judged) | {"word": simulation.actions[judged.action]}
    else:
        truth_outcome = {"action": instructed, "word": simulation.actions[instructed]}
    start, end = recording.start, recording.end
    messages = [
        Message(topics.CAMERA, start, believed(generator(seed, "camera", names[0]), simulation.camera)),
        Message(topics.ROBOT_DESCRIPTION, start, world.description),
        Message(topics.TRUTH_SCENE, start, json.dumps(truth, sort_keys=True)),
        *recording.messages(noise, simulation),
        Message(topics.SENTENCE, end, " ".join(said)),
        Message(topics.TRUTH_OUTCOME, end, json.dumps(truth_outcome, sort_keys=True)),
    ]
    messages.sort(key=lambda message: message.time)
    return Log(_metadata(simulation, names, seed, provenance), tuple(messages))


def _metadata(
    simulation: Simulation, names: tuple[str, str, int], seed: int, provenance: Mapping[str, str]
) -> dict[str, str]:
    settings = simulation.to_json()
    return {
        **provenance,
        "experiment": names[0],
        "set": names[1],
        "trial": str(names[2]),
        "seed": str(seed),
        "settings": settings,
        "settings_sha256": hashlib.sha256(settings.encode()).hexdigest(),
        "joint_names": " ".join(JOINT_NAMES),
        "tactile_names": " ".join(TACTILE_NAMES),
        "units": "metres, radians, seconds; touch 0..1; robot frame: x ahead, y left, z up, origin at root_link",
    }
