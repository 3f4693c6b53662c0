"""Scenes to talk about: those of a study's tests, and new ones drawn in its simulation."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

from data_collection.log.mcap_log import Log, read_log
from data_collection.log.trial import observation
from data_collection.simulation_settings import Simulation
from evaluation.talk.robots import Robot, TalkError
from features.extraction_settings import FeatureSettings
from features.object_feature import weights_provenance
from features.percept_data import Percepts, load_percepts, only
from features.table import FeatureTable, read_table
from features.transforms import Transforms, apply

FIRST_DRAWN = 10_000
"""New scenes have the numbers after it: so many trials of a test set may a config ask for, and none is met again."""
MOST_DRAWN = 900_000
"""The highest number of a new scene: logs number trials up to a million."""

SetName = Literal["generation", "description"]


@dataclass(frozen=True)
class SceneName:
    """Which scene: the number of a trial of the test set, or of a new draw."""

    number: int
    drawn: bool = False

    def __str__(self) -> str:
        """What people read."""
        return f"{'draw' if self.drawn else 'scene'} {self.number}"

    @property
    def trial(self) -> int:
        """The number of its trial."""
        return self.number + FIRST_DRAWN * self.drawn


@dataclass(frozen=True, eq=False)
class Scene:
    """What there is to see, for whichever robot that shares the data looks at it.

    Attributes:
        name: Which scene.
        percepts: What was seen of it, one trial; None where the features are somebody's own.
        log: What was recorded of it; None where the results have none.
    """

    name: SceneName
    percepts: Percepts | None
    log: Log | None

    @property
    def said(self) -> str:
        """What the tutor said."""
        return "" if self.log is None else " ".join(observation(self.log).words)


@dataclass(frozen=True)
class Scenes:
    """The scenes of a data set, and what simulates more of them.

    Attributes:
        results: The folder of results.
        data: Name of the data set.
        weights: The file of the network's weights, where the study used one of its own.
    """

    results: Path
    data: str
    weights: Path | None = None

    @cached_property
    def calibration(self) -> Log | None:
        """The log of the camera's calibration; None where the data were not simulated by the study."""
        path = self.results / "mcap" / self.data / "calibration.mcap"
        return read_log(path) if path.is_file() else None

    @property
    def simulation(self) -> Simulation | None:
        """The settings of the simulation; None where there was none."""
        told = None if self.calibration is None else self.calibration.metadata.get("settings")
        return None if told is None else Simulation.model_validate_json(told)

    @property
    def seed(self) -> int:
        """The seed of the data."""
        return 0 if self.calibration is None else int(self.calibration.metadata["seed"])

    def numbers(self, robot: Robot, set_name: SetName = "generation") -> list[int]:
        """The numbers of the scenes of a test set; where there is no such set, those of training."""
        blocks = [number for _, numbers in self._blocks(set_name) for number in numbers]
        return blocks or [int(number) for number in self.table(robot, set_name).trial]

    def scene(self, robot: Robot, name: SceneName, set_name: SetName = "generation") -> Scene:
        """Look at a scene; a new one is simulated.

        Raises:
            TalkError: There is no such scene, or it cannot be simulated; the message says what is allowed.
        """
        if name.drawn:
            return self._draw(robot, name, set_name)
        numbers = self.numbers(robot, set_name)
        if name.number not in numbers:
            raise TalkError(f"there is no scene {name.number} (allowed: {_spans(numbers)})")
        path = next((path for path, own in self._blocks(set_name) if name.number in own), None)
        if path is None:
            return Scene(name, None, None)
        part = path.name.split("_")[0]
        log = self.results / "mcap" / self.data / part / f"trial_{name.number:04}.mcap"
        try:
            percepts = only(load_percepts(path), name.number)
        except ValueError as error:
            raise TalkError(f"scene {name.number} was dropped: {error}") from error
        return Scene(name, percepts, read_log(log) if log.is_file() else None)

    def features(self, robot: Robot, scene: Scene, set_name: SetName = "generation") -> tuple[FeatureTable, int]:
        """The features of a scene as a robot sees it: a table, and the row of the scene in it."""
        if scene.percepts is not None and robot.transforms is not None:
            return apply(robot.transforms, scene.percepts), 0
        table = self.table(robot, set_name)
        return table, table.trial.tolist().index(scene.name.number)

    def table(self, robot: Robot, set_name: SetName = "generation") -> FeatureTable:
        """The features of the test set, or of training where there is none."""
        folder = self.results / "features" / self.data / f"D{robot.name.D}"
        for part in (set_name, "train"):
            trials, objects = (folder / f"{part}_{kind}.parquet" for kind in ("trials", "objects"))
            if trials.is_file():
                return read_table(trials, objects, need_attention=False)
        raise TalkError(f"{folder}: there are no features")

    def _blocks(self, set_name: SetName) -> list[tuple[Path, range]]:
        """The files of percepts of a set, or else of training, each with the numbers of its trials."""
        for part in (set_name, "train"):
            paths = sorted((self.results / "percepts" / self.data).glob(f"{part}_*.npz"))
            named = [(path, re.fullmatch(r"[a-z]+_(\d+)-(\d+)", path.stem)) for path in paths]
            if found := [(path, range(int(own[1]), int(own[2]) + 1)) for path, own in named if own]:
                return found
        return []

    def _draw(self, robot: Robot, name: SceneName, set_name: SetName) -> Scene:
        simulation, calibration, transforms = self.simulation, self.calibration, robot.transforms
        # Loaded for new scenes only: whoever asks about another one need not wait for it.
        from data_collection.episode import collect
        from features.percepts import DetectionError, perceive

        if simulation is None or calibration is None or transforms is None:
            raise TalkError(f"{self.data}: scenes are not simulated, so that none can be drawn")
        if not 1 <= name.number <= MOST_DRAWN:
            raise TalkError(f"draw {name.number}: a number from 1 to {MOST_DRAWN:,} is expected")
        extraction = extraction_of(transforms, self.weights)
        (log,) = collect(
            simulation,
            experiment=self.data,
            set_name=set_name,
            trials=[name.trial],
            seed=self.seed,
            provenance={},
        )
        try:
            return Scene(name, perceive([log], calibration, extraction), log)
        except DetectionError as error:
            raise TalkError(f"{name}: the robot does not see the objects apart; take another ({error})") from error


def extraction_of(transforms: Transforms, weights: Path | None) -> FeatureSettings:
    """The settings with which a robot's features were made.

    Raises:
        TalkError: Its network has weights from a file, and not this file is given.
    """
    told = json.loads(transforms.provenance)
    settings, made = told["settings"], str(told["weights"])
    kept = {"seeded": "seeded", "torchvision": "imagenet1k"}.get(made.split()[0])
    if kept is None and weights is None:
        raise TalkError(f"a new scene needs the network's weights ({made}): give their file as --weights FILE")
    extraction = FeatureSettings.model_validate(settings | {"weights": kept or str(weights)})
    if weights_provenance(extraction) != made:
        raise TalkError(f"{weights}: these are not the weights that the robot sees with ({made})")
    return extraction


def _spans(numbers: list[int]) -> str:
    return str(numbers[0]) if len(numbers) == 1 else f"{numbers[0]} to {numbers[-1]}"
