"""Robot, table and objects together: set up a scene, carry out an action, record what the robot senses."""

import math
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from data_collection.log import topics
from data_collection.log.messages import Floats, Image
from data_collection.simulation_settings import Simulation
from data_collection.simulator import hand_model, robot_model, scene
from data_collection.simulator.inverse_kinematics import look, reach
from data_collection.simulator.kinematics import HAND, Kinematics, rotation
from data_collection.simulator.postures import COMFORTABLE, REST, angles_of
from data_collection.simulator.recording import Recorder, Recording, Sample, smooth
from data_collection.simulator.robot import Robot, finger_angles
from data_collection.simulator.simple_meshes import with_simple_meshes
from data_collection.task import Outcome, Placed

_PALM_GAP = 0.003
"""Between palm and top of the object in the best grasp, metres."""
_OWN_CELL, _OUTSIDE_CELL = 0.006, 0.002
"""Vertices of the robot's meshes that share a cube of this side, metres, are one: as its own eyes and others see it.

From outside, joints are seen whose parts lie less than 6 mm inside each other.
"""
_SETTLING = 24
"""Physics steps that objects are given to come to rest."""


class World:
    """One simulated robot at its table, shared by many trials; `set_up` makes each start from the same state.

    Args:
        simulation: Settings of the experiment.
        whole_robot: Draw legs, head and left arm too, which its own eyes do not look at: for pictures from outside.
        watch: Is shown what the robot senses while it acts, sample by sample.
    """

    def __init__(
        self,
        simulation: Simulation,
        *,
        whole_robot: bool = False,
        watch: Callable[[Sample], None] | None = None,
    ) -> None:
        self.simulation = simulation
        self._watch = watch
        self.description = robot_model.robot_urdf(meshes=False)
        self._folder = tempfile.TemporaryDirectory()
        drawn = robot_model.robot_urdf(own_view=not whole_robot)
        self._urdf = with_simple_meshes(drawn, Path(self._folder.name), _OUTSIDE_CELL if whole_robot else _OWN_CELL)
        self.client: Any = scene.connect()
        self.kinematics = Kinematics(self.description)
        self.rest_angles = angles_of(REST, self.kinematics)
        self._comfortable = angles_of(COMFORTABLE, self.kinematics)
        self.objects: list[int] = []
        self.placed: tuple[Placed, ...] = ()
        self._clear()

    def __enter__(self) -> Self:
        """Return the world; leaving the block closes its client."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the client, and remove its files."""
        self.client.disconnect()
        self._folder.cleanup()

    def set_up(self, placed: Sequence[Placed], light: np.random.Generator | None) -> None:
        """Empty the world, put the robot at rest and the objects on the table, and let them settle.

        Args:
            placed: Objects.
            light: Draws this trial's light; None is the nominal light.
        """
        self._clear()
        settings = self.simulation
        lamp = settings.light
        self._direction = np.array(lamp.direction)
        self._brightness = 1.0
        if light is not None:
            self._direction = self._direction + lamp.direction_spread * light.normal(size=3)
            self._brightness = max(0.3, 1.0 + lamp.brightness_spread * float(light.normal()))
        self._table = scene.add_table(self.client, settings.table)
        self.placed = tuple(placed)
        self.objects = [
            scene.add_object(
                self.client,
                item,
                settings.colors[item.kind.color][item.kind.shade],
                settings.table.height,
                settings.hand.friction,
            )
            for item in placed
        ]
        self.robot.drive(self.rest_angles, np.zeros(len(self.rest_angles)))
        for _ in range(_SETTLING):
            self.client.stepSimulation()

    def picture(self) -> Image:
        """Return what the left eye sees, as rendered."""
        camera = self.simulation.camera
        pose = self.robot.link_pose(robot_model.LEFT_EYE_LINK)
        axes = rotation(pose[3:])
        view = scene.View(pose[:3], axes[:, 0], axes[:, 2], camera.width, camera.height, camera.view)
        return scene.render(self.client, view, self.simulation.light, self._direction, self._brightness)

    def photograph(self, view: scene.View) -> Image:
        """Return a picture from any place, for documentation."""
        return scene.render(self.client, view, self.simulation.light, self._direction, self._brightness)

    def arrange(self, angles: Floats, poses: Floats | None) -> None:
        """Put joints (25,) and objects (M, 7) where a log has them, without physics: to draw what was recorded."""
        self.robot.place(angles)
        if poses is not None:
            for body, pose in zip(self.objects, poses, strict=True):
                self.client.resetBasePositionAndOrientation(body, pose[:3].tolist(), pose[3:].tolist())

    def best_grasp(self, index: int) -> Floats:
        """Return where the grasp point (3,) holds an object best: over its middle, as low as top and table allow."""
        pose = scene.object_pose(self.client, self.objects[index])
        item = self.placed[index]
        top = self.simulation.table.height + (item.kind.size if item.kind.shape == "ball" else item.kind.height)
        return np.array([pose[0], pose[1], max(top - hand_model.PALM_DEPTH + _PALM_GAP, self.lowest_grasp)])

    @property
    def lowest_grasp(self) -> float:
        """Height of the grasp point at which the thumb is just clear of the table, metres."""
        return self.simulation.table.height + hand_model.TIP_REACH + 0.002

    def rest(self) -> Recording:
        """Record the scene and the resting robot."""
        recorder = self._recorder()
        recorder.snapshot(topics.IMAGE_BEFORE)
        nothing = Outcome(0.0, 0.0, 0.0, 0.0, None, ())
        return recorder.finish(nothing)

    def act(
        self,
        attended: int,
        target: Floats | None,
        finger_rate: float,
        gaze_offset: Floats,
        lifts: Callable[[float], bool],
    ) -> Recording:
        """Look at an object, bring the hand to `target`, bend the fingers, and test by lifting what is in the hand.

        Args:
            attended: Index of the object to look at.
            target: (3,) for the grasp point, metres, robot frame; None leaves the hand at rest.
            finger_rate: Bend of the fingers, 0..1.
            gaze_offset: (2,) by how much the fixation point misses the middle of the object, metres.
            lifts: Whether to test by lifting, given the force between hand and object, newtons.
        """
        motion = self.simulation.motion
        recorder = self._recorder()
        recorder.snapshot(topics.IMAGE_BEFORE)
        before = [scene.object_pose(self.client, body) for body in self.objects]
        fixation = before[attended][:3] + np.array([*gaze_offset, 0.0])
        recorder.command(topics.GAZE_TARGET, fixation)
        posture = look(self.kinematics, fixation, self.rest_angles, self.rest_angles)
        recorder.move(self.rest_angles, posture, motion.gaze_time)
        recorder.move(posture, posture, 0.1)
        recorder.snapshot(topics.IMAGE_GAZE)
        recorder.command(topics.FINGER_RATE, finger_rate)
        if target is None:
            recorder.move(posture, posture, motion.bend_time)
        else:
            recorder.command(topics.HAND_TARGET, target)
            posture = self._grasp(recorder, posture, target, finger_rate, fixation)
        recorder.sample()
        recorder.snapshot(topics.IMAGE_AFTER)
        ended = recorder.now()
        hand = self.robot.link_pose(hand_model.GRASP_LINK)[:3]
        force = recorder.force(self.objects[attended])
        rise = self._lift(posture, self.objects[attended]) if target is not None and lifts(force) else 0.0
        after = [scene.object_pose(self.client, body) for body in self.objects]
        outcome = Outcome(
            displacement=float(np.linalg.norm(hand - recorder.rest_hand)),
            force=force,
            finger_rate=finger_rate,
            rise=rise,
            hand_error=None if target is None else float(np.linalg.norm(hand - target)),
            toppled=tuple(
                index for index in range(len(before)) if index != attended and _moved(before[index], after[index])
            ),
        )
        return recorder.finish(outcome, ended)

    def _grasp(self, recorder: Recorder, posture: Floats, target: Floats, rate: float, fixation: Floats) -> Floats:
        """Go over the target, come down on it with open fingers, bend them; return the last posture."""
        motion = self.simulation.motion
        # The hand comes down at last, on a straight line through a few points: on its way it knocks over nothing.
        heights = np.linspace(motion.clearance, 0.0, 4)
        postures = []
        start = posture
        for height in heights:
            start = reach(self.kinematics, target + np.array([0.0, 0.0, height]), start, self._comfortable)
            start = look(self.kinematics, fixation, start, self.rest_angles)
            start[HAND] = finger_angles(0.0)
            postures.append(start)
        recorder.move(posture, postures[0], motion.transfer_time)
        recorder.follow(postures, motion.descent_time)
        last = postures[-1].copy()
        last[HAND] = finger_angles(rate)
        recorder.move(postures[-1], last, 0.6 * motion.bend_time)
        recorder.move(last, last, 0.4 * motion.bend_time)
        return last

    def _lift(self, posture: Floats, body: int) -> float:
        """Lift the hand with the fingers as they are; return by how much the object rose, metres."""
        motion = self.simulation.motion
        low = scene.object_pose(self.client, body)[2]
        hand = self.kinematics.pose(hand_model.GRASP_LINK, posture).position
        raised = reach(self.kinematics, hand + np.array([0.0, 0.0, motion.lift_height]), posture, self._comfortable)
        steps = round(motion.lift_time / scene.TIME_STEP)
        for step in range(1, steps + 1):
            angles, velocities = smooth(posture, raised, min(1.0, step / (0.7 * steps)), 0.7 * motion.lift_time)
            self.robot.drive(angles, velocities)
            self.client.stepSimulation()
        return float(scene.object_pose(self.client, body)[2] - low)

    def _recorder(self) -> Recorder:
        return Recorder(
            self.client, self.robot, self.objects, self._table, self.picture, self.simulation, self._watch
        )

    def _clear(self) -> None:
        scene.reset(self.client)
        self.robot = Robot(self.client, self._urdf, self.kinematics)
        self.robot.set_finger_torque(self.simulation.hand.finger_torque, self.simulation.hand.friction)
        self.robot.place(self.rest_angles)


def _moved(before: Floats, after: Floats) -> bool:
    """Tell whether an object was pushed by over 2 cm or tilted by over 30 degrees."""
    tilt = math.degrees(math.acos(np.clip(rotation(before[3:])[:, 2] @ rotation(after[3:])[:, 2], -1.0, 1.0)))
    return bool(np.linalg.norm(after[:3] - before[:3]) > 0.02 or tilt > 30.0)
