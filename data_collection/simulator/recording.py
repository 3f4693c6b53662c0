"""What a trial leaves behind: senses and commands sampled while the robot moves, and the messages made of them."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from data_collection.joints import JOINT_NAMES, TACTILE_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Message
from data_collection.log.messages import Floats, Image, JointState, Transform, Value
from data_collection.simulation_settings import Simulation
from data_collection.simulator import hand_model, robot_model, scene
from data_collection.simulator.camera import expose
from data_collection.simulator.kinematics import Kinematics
from data_collection.simulator.robot import Robot
from data_collection.task import Outcome

_OPTICAL = np.array([0.5, -0.5, 0.5, -0.5])
"""Quaternion from the eye's frame (x ahead) to the camera's optical frame (z ahead, x right)."""
_TOUCH_AVERAGE = 24
"""Physics steps over which contact forces are averaged: 0.1 s, the skin's own low-pass."""


_LOOK_EVERY, _NEAR = 6, 0.05
"""So often, in steps, a gliding hand looks whether anything is so near, metres: it cannot pass at up to 2 m/s."""


@dataclass(frozen=True)
class Sample:
    """What the robot senses of itself at one time."""

    time: int
    position: Floats
    velocity: Floats
    touch: Floats
    objects: Floats


@dataclass(frozen=True)
class Recording:
    """All that was sensed and sent in a trial, before noise.

    Attributes:
        start: Time of the first message, nanoseconds.
        end: Time at which the action was over.
        samples: At the fixed rate; the last one is the end of the action.
        pictures: Topic, time and image as rendered.
        commands: Further messages: gaze and hand targets, finger rate, truth poses, transforms.
        kinematics: Of the robot, with the limits of its joints.
        outcome: What physically happened.
    """

    start: int
    end: int
    samples: tuple[Sample, ...]
    pictures: tuple[tuple[str, int, Image], ...]
    commands: tuple[Message, ...]
    kinematics: Kinematics
    outcome: Outcome

    def messages(self, rng: np.random.Generator, simulation: Simulation) -> list[Message]:
        """Return the messages of the log, with the noise of camera, encoders and skin, in time order."""
        noise = simulation.noise
        found = [Message(topic, time, expose(rng, image, simulation.camera)) for topic, time, image in self.pictures]
        limits = {topics.JOINT_LOWER: self.kinematics.lower, topics.JOINT_UPPER: self.kinematics.upper}
        for topic, limit in limits.items():
            found.append(Message(topic, self.start, JointState(JOINT_NAMES, limit, np.zeros(0))))
        for sample in self.samples:
            read = sample.position + rng.normal(size=sample.position.shape) * math.radians(noise.joints)
            felt = np.clip(sample.touch + rng.normal(size=sample.touch.shape) * noise.tactile, 0.0, 1.0)
            values: list[tuple[str, Value]] = [
                (topics.JOINT_STATES, JointState(JOINT_NAMES, read, sample.velocity)),
                (topics.TACTILE, felt),
                (topics.HAND_POSE, self.kinematics.pose(hand_model.GRASP_LINK, read).flat()),
                (topics.TRUTH_POSES, sample.objects),
            ]
            found += [Message(topic, sample.time, value) for topic, value in values]
        return sorted([*found, *self.commands], key=lambda message: message.time)


class Recorder:
    """Drives the robot along postures and keeps what it senses on the way.

    Args:
        client: PyBullet client.
        robot: The acting robot.
        objects: PyBullet's numbers of the objects.
        table: PyBullet's number of the table.
        picture: Renders what the left eye sees now.
        simulation: Settings.
        watch: Is shown every sample as soon as it is kept.
    """

    def __init__(
        self,
        client: Any,
        robot: Robot,
        objects: Sequence[int],
        table: int,
        picture: Callable[[], Image],
        simulation: Simulation,
        watch: Callable[[Sample], None] | None = None,
    ) -> None:
        self._client = client
        self._watch = watch
        self._robot = robot
        self._objects = objects
        self._around = (table, *objects)
        self._picture = picture
        self._simulation = simulation
        self._step = 0
        self._every = max(1, round(1.0 / (simulation.motion.log_rate * scene.TIME_STEP)))
        self._samples: list[Sample] = []
        self._pictures: list[tuple[str, int, Image]] = []
        self._commands: list[Message] = []
        self._forces: list[dict[int, Floats]] = []
        # Nothing moves but the robot until it comes near to something: from then on, all that happens is physics.
        self._glides = not robot.near(self._around, _NEAR)
        self.rest_hand = robot.link_pose(hand_model.GRASP_LINK)[:3]
        self.sample()

    def now(self) -> int:
        """Return the time now, nanoseconds."""
        return round(self._step * scene.TIME_STEP * 1e9)

    def move(self, start: Floats, goal: Floats, seconds: float) -> None:
        """Drive from one posture to another on a minimum-jerk path."""
        steps = round(seconds / scene.TIME_STEP)
        for step in range(1, steps + 1):
            self._advance(*smooth(start, goal, step / steps, seconds))

    def follow(self, postures: Sequence[Floats], seconds: float) -> None:
        """Drive through postures with one smooth start and stop."""
        from scipy.interpolate import CubicSpline

        path = CubicSpline(np.linspace(0.0, 1.0, len(postures)), np.array(postures), bc_type="natural")
        steps = round(seconds / scene.TIME_STEP)
        for step in range(1, steps + 1):
            share, speed = _minimum_jerk(step / steps)
            self._advance(path(share), path(share, 1) * speed / seconds)

    def sample(self) -> None:
        """Keep what the robot senses of itself now, once."""
        if self._samples and self._samples[-1].time == self.now():
            return
        self._shown()
        position, velocity = self._robot.joint_state()
        poses = np.array([scene.object_pose(self._client, body) for body in self._objects]).reshape(-1, 7)
        self._samples.append(Sample(self.now(), position, velocity, self._touch(), poses))
        if self._watch is not None:
            self._watch(self._samples[-1])

    def snapshot(self, topic: str) -> None:
        """Take a picture, and note where the links are."""
        self._shown()
        self._pictures.append((topic, self.now(), self._picture()))
        transforms = [Transform(topics.ROOT_FRAME, name, pose) for name, pose in self._robot.link_poses()] + [
            Transform(robot_model.LEFT_EYE_LINK, topics.CAMERA_FRAME, np.array([0.0, 0.0, 0.0, *_OPTICAL]))
        ]
        self._commands.append(Message(topics.TF, self.now(), tuple(transforms)))

    def command(self, topic: str, value: Value) -> None:
        """Keep a message that the robot sends to itself."""
        self._commands.append(Message(topic, self.now(), value))

    def force(self, body: int) -> float:
        """Return the mean force between the hand and an object over the last moments, newtons."""
        if not self._forces:
            return 0.0
        return float(sum(forces[body].sum() for forces in self._forces if body in forces) / len(self._forces))

    def finish(self, outcome: Outcome, ended: int | None = None) -> Recording:
        """Return what was recorded."""
        return Recording(
            0, self.now() if ended is None else ended, tuple(self._samples), tuple(self._pictures),
            tuple(self._commands), self._robot.kinematics, outcome,
        )  # fmt: skip

    def _advance(self, angles: Floats, velocities: Floats) -> None:
        self._step += 1
        if self._glides:
            self._robot.glide(angles, velocities)
            self._forces.append({})
            if self._step % _LOOK_EVERY == 0:
                self._robot.show()
                self._glides = not self._robot.near(self._around, _NEAR)
        else:
            self._robot.drive(angles, velocities)
            self._client.stepSimulation()
            self._forces.append(self._robot.contact_forces(self._objects))
        del self._forces[:-_TOUCH_AVERAGE]
        if self._step % self._every == 0:
            self.sample()

    def _shown(self) -> None:
        """Let the physics engine, which is asked for joints, links and pictures, know where the robot is."""
        if self._glides:
            self._robot.show()

    def _touch(self) -> Floats:
        """Return the nine touch values in 0..1."""
        total = np.zeros(len(TACTILE_NAMES))
        for forces in self._forces:
            for parts in forces.values():
                total += parts[: len(total)]
        mean = total / max(1, len(self._forces))
        return np.clip(mean / self._simulation.hand.saturation, 0.0, 1.0)


def _minimum_jerk(share: float) -> tuple[float, float]:
    """Return position and speed at a share 0..1 of the time of a movement from 0 to 1."""
    position = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
    return position, 30.0 * share**2 * (1.0 - share) ** 2


def smooth(start: Floats, goal: Floats, share: float, seconds: float) -> tuple[Floats, Floats]:
    """Return posture and velocity at a share 0..1 of a minimum-jerk movement of `seconds`."""
    position, speed = _minimum_jerk(share)
    return start + position * (goal - start), speed / seconds * (goal - start)
