"""Trials from beginning to end: scene, gaze, action, tutor, log."""

import hashlib
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from data_collection import exam, task
from data_collection.joints import JOINT_NAMES, TACTILE_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Log, Message
from data_collection.log.messages import Floats, Value
from data_collection.seeding import generator
from data_collection.simulation_settings import Simulation
from data_collection.simulator import scene
from data_collection.simulator.camera import believed, expose
from data_collection.simulator.recording import Recording, Sample
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
        set_name: `train` (an action, and the tutor's sentence about it), `description` (likewise, tried until the
            tutor says the word that is due) or `generation` (a scene and an instruction that one object fits; no
            action). What is due in a trial of a test set is told by `design`.
        trials: Numbers from 1.
        seed: Seed of the study.
        provenance: Further metadata of the log, such as hashes of code and lock file.

    Raises:
        ValueError: Unknown set, or trial below 1; or the tutor does not say what is due, whatever is tried.
    """
    if set_name not in SETS:
        raise ValueError(f"set {set_name!r} is none of {', '.join(SETS)}")
    if any(trial < 1 for trial in trials):
        raise ValueError("trials are counted from 1")
    with World(simulation) as world:
        for trial in trials:
            one = _Trial(world, (experiment, set_name, trial), seed, provenance)
            yield {"train": one.act, "generation": one.instruct, "description": one.examine}[set_name]()


def execute(
    simulation: Simulation,
    *,
    experiment: str,
    seed: int,
    commands: Sequence[task.Command],
    provenance: Mapping[str, str],
    set_name: str = "generation",
    watch: Callable[[Sample], None] | None = None,
) -> Iterator[Log]:
    """Carry out actions in the scenes of instructions, in one world; yield the log of what happened for each.

    Args:
        simulation: Settings of the experiment.
        experiment: Its name.
        seed: Seed of the study.
        commands: What to do in the scene of which instruction.
        provenance: Further metadata of the logs.
        set_name: Set of the scenes.
        watch: Is shown what the robot senses while it acts, sample by sample; it changes nothing.
    """
    with World(simulation, watch=watch) as world:
        for command in commands:
            told = {**provenance, "command": json.dumps(asdict(command), sort_keys=True)}
            yield _Trial(world, (experiment, set_name, command.trial), seed, told).obey(command)


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


@dataclass(frozen=True)
class _Trial:
    """One trial in a world: what is drawn in it depends on its names and the seed alone.

    Attributes:
        world: Where it takes place.
        names: Experiment, set and trial.
        seed: Seed of the study.
        provenance: Further metadata of the log.
        attempt: Which attempt it is, from 1; 0 of a trial that is taken as it comes.
    """

    world: World
    names: tuple[str, str, int]
    seed: int
    provenance: Mapping[str, str]
    attempt: int = 0

    @property
    def _simulation(self) -> Simulation:
        return self.world.simulation

    def _rng(self, purpose: str) -> np.random.Generator:
        path = ("attempt", self.attempt) if self.attempt else ()
        return generator(self.seed, "collect", *self.names, *path, purpose)

    def act(self) -> Log:
        """Act on the robot's own account; the tutor says what happened."""
        placed = task.draw_scene(self._rng("scene"), self._simulation)
        plan = task.draw_plan(self._rng("plan"), self._simulation, len(placed))
        return self._told(placed, plan.attended, self._carry_out(placed, plan))

    def examine(self) -> Log:
        """Act anew until the tutor says what is due in a fair test set.

        Raises:
            ValueError: The tutor does not say it in many attempts.
        """
        due = exam.target_of(self._simulation, self.names, self.seed)
        for number in range(1, exam.MOST_ATTEMPTS + 1):
            one = replace(self, attempt=number)
            placed, attended = exam.draw_scene_with(one._rng("scene"), self._simulation, due.kind, due.place)
            plan = exam.draw_plan_for(one._rng("plan"), self._simulation, attended, due.action)
            recording = one._carry_out(placed, plan)
            if task.judge(recording.outcome, self._simulation).action == due.action:
                return one._told(placed, attended, recording)
        raise ValueError(exam.never_said(due, self.names, self._simulation))

    def instruct(self) -> Log:
        """Rest; the tutor says what to do."""
        placed, attended, action = exam.draw_instruction(self._simulation, self.names, self.seed)
        self.world.set_up(placed, self._rng("light"))
        words = task.channel_words(self._simulation, action, placed[attended])
        return self._log(placed, attended, self.world.rest(), words, action)

    def obey(self, command: task.Command) -> Log:
        """Carry out an action in the scene of an instruction."""
        placed, asked, action = exam.draw_instruction(self._simulation, self.names, self.seed)
        words = task.channel_words(self._simulation, action, placed[asked])
        attended = command.nearest(placed)
        self.world.set_up(placed, self._rng("light"))
        goal = None if command.target is None else np.array(command.target, dtype=np.float64)
        return self._log(placed, attended, self._perform(attended, goal, command.finger_rate), words)

    def _carry_out(self, placed: Sequence[task.Placed], plan: task.Plan) -> Recording:
        """Set a scene up, and do in it what was planned."""
        self.world.set_up(placed, self._rng("light"))
        goal = None
        if plan.moves:
            goal = self.world.best_grasp(plan.attended) + np.array(plan.offset)
            goal[2] = max(goal[2], self.world.lowest_grasp)
        return self._perform(plan.attended, goal, plan.finger_rate)

    def _told(self, placed: Sequence[task.Placed], attended: int, recording: Recording) -> Log:
        """The log of an action on the robot's own account, with the tutor's words for what happened."""
        action = task.judge(recording.outcome, self._simulation).action
        return self._log(placed, attended, recording, task.channel_words(self._simulation, action, placed[attended]))

    def _perform(self, attended: int, target: Floats | None, rate: float) -> Recording:
        """Act; the hand is lifted only from an object that it touches."""
        tutor = self._simulation.tutor
        offset = self._simulation.noise.gaze * self._rng("gaze").normal(size=2)
        return self.world.act(attended, target, rate, offset, lifts=lambda force: task.touches(force, tutor))

    def _log(
        self,
        placed: Sequence[task.Placed],
        attended: int,
        recording: Recording,
        words: dict[str, str],
        instructed: str | None = None,
    ) -> Log:
        simulation = self._simulation
        truth: dict[str, Any] = {"objects": task.describe(placed), "attended": attended}
        if instructed is None:
            judged = task.judge(recording.outcome, simulation)
            truth_outcome = vars(recording.outcome) | vars(judged) | {"word": simulation.actions[judged.action]}
            truth_outcome |= {"attempts": self.attempt} if self.attempt else {}
        else:
            truth_outcome = {"action": instructed, "word": simulation.actions[instructed]}
        start, end = recording.start, recording.end
        messages = [
            Message(topics.CAMERA, start, believed(generator(self.seed, "camera", self.names[0]), simulation.camera)),
            Message(topics.ROBOT_DESCRIPTION, start, self.world.description),
            Message(topics.TRUTH_SCENE, start, json.dumps(truth, sort_keys=True)),
            *recording.messages(self._rng("noise"), simulation),
            Message(topics.SENTENCE, end, " ".join(task.utter(self._rng("sentence"), words))),
            Message(topics.TRUTH_OUTCOME, end, json.dumps(truth_outcome, sort_keys=True)),
        ]
        messages.sort(key=lambda message: message.time)
        return Log(_metadata(simulation, self.names, self.seed, self.provenance), tuple(messages))


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
