"""From answers to actions: what the robot does when it was told to, carried out in the simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from data_collection.episode import execute
from data_collection.log.mcap_log import write_log
from data_collection.log.truth import truth
from data_collection.simulation_settings import Simulation
from data_collection.task import Command
from evaluation.generation import objects_of
from features.action import FINGER_RATE
from features.table import FeatureTable
from features.transforms import Transforms
from model import Fit
from model.data import Floats
from model.prediction import Answer


def commands(
    rng: np.random.Generator,
    fit: Fit,
    transforms: Transforms,
    table: FeatureTable,
    answered: Sequence[Answer],
    rest: Floats,
) -> tuple[Command, ...]:
    """Turn answers into actions: of the mean μ^a_k the gaze, the hand's target and the finger rate are carried out.

    A target that is nearer to the hand's rest position than to the object leaves the hand at rest: that is what
    a learned look-at is.

    Args:
        rng: Decides between tied choices.
        fit: What the robot learned.
        transforms: Fitted with the features that the fit has seen; they undo the scaling of actions.
        table: The instructions' scenes.
        answered: How the robot understands each instruction.
        rest: (D, 3) where the hand rests in each scene, metres, robot frame.
    """
    told = []
    for d, answer in enumerate(answered):
        choices = answer.choices()
        m, k = choices[int(rng.integers(len(choices)))]
        place = objects_of(table, d)["position"][m]
        mean = fit.knowledge.categories.mean[0][k]
        target = transforms.hand_target(mean, place)
        on_table = np.array([*place, float(transforms.table_height)])
        stays = bool(np.linalg.norm(target - rest[d]) < np.linalg.norm(target - on_table))
        rate = float(np.clip(transforms.action_scale.unscale(mean)[FINGER_RATE], 0.0, 1.0))
        reach = None if stays else (float(target[0]), float(target[1]), float(target[2]))
        gaze = (float(place[0]), float(place[1]))
        told.append(Command(int(table.trial[d]), gaze, reach, 0.0 if stays else rate))
    return tuple(told)


def carry_out(
    simulation: Simulation,
    told: Sequence[Command],
    *,
    experiment: str,
    seed: int,
    provenance: Mapping[str, str],
    folder: Path,
) -> list[str | None]:
    """Carry out actions in the simulated scenes of instructions; the tutor's word for what happened in each.

    Args:
        simulation: Settings of the experiment whose scenes they are.
        told: What to do in which scene.
        experiment: Its name.
        seed: Of its data.
        provenance: Further metadata of the logs.
        folder: Where the log of each is written, `trial_0001.mcap`, …
    """
    words = []
    logs = execute(simulation, experiment=experiment, seed=seed, commands=told, provenance=provenance)
    for command, log in zip(told, logs, strict=True):
        write_log(folder / f"trial_{command.trial:04}.mcap", log)
        happened = truth(log)
        words.append(happened.action_word if happened else None)
    return words
