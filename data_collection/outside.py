"""The robot at its table seen from outside, at joint states that were recorded or are being recorded."""

import json
from types import TracebackType
from typing import Self

import numpy as np

from data_collection import task
from data_collection.apparatus import ObjectKind
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError
from data_collection.log.messages import Floats, Image
from data_collection.simulation_settings import Simulation
from data_collection.simulator import scene
from data_collection.simulator.world import World

_EYE, _TOWARDS = np.array([1.02, -0.46, 0.50]), np.array([0.14, -0.02, 0.06])


class Outside:
    """A world of its own, in which nothing moves by itself: it is put where others have been.

    Args:
        log: Of the scene. Objects are drawn where its truth topics have them; without these the robot is alone.
        width: Columns of the pictures.
        height: Rows.

    Raises:
        LogError: The log is of a simulation with settings, or a scene, that this version does not know.
    """

    def __init__(self, log: Log, width: int, height: int) -> None:
        try:
            simulation, placed = settings_of(log), _placed(log)
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            says = f"its settings or its {topics.TRUTH_SCENE} do not fit this version, to draw it ({error!r})"
            raise LogError(f"{log.source}: {says}") from error
        ahead = (_TOWARDS - _EYE) / np.linalg.norm(_TOWARDS - _EYE)
        self._view = scene.View(_EYE, ahead, np.array([0.0, 0.0, 1.0]), width, height, 46.0)
        self._world = World(simulation, whole_robot=True)
        self._world.set_up(placed, None)

    def __enter__(self) -> Self:
        """Return the view; leaving the block closes its world."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the world."""
        self._world.__exit__(kind, error, trace)

    def picture(self, joints: Floats, poses: Floats | None) -> Image:
        """Return the picture of the robot with joints (25,), radians, and the objects at poses (M, 7)."""
        at = poses if self._world.objects else None
        self._world.arrange(joints, None if at is None else np.asarray(at, dtype=np.float64))
        return self._world.photograph(self._view)


def settings_of(log: Log) -> Simulation:
    """Return the settings of the simulation that a log comes from; the defaults where it tells none."""
    settings = log.metadata.get("settings")
    return Simulation.model_validate(json.loads(settings)) if settings else Simulation()


def _placed(log: Log) -> list[task.Placed]:
    text = next((str(message.value) for message in log.messages if message.topic == topics.TRUTH_SCENE), None)
    if text is None or "settings" not in log.metadata:
        return []
    return [
        task.Placed(
            ObjectKind(**{key: item[key] for key in ObjectKind.model_fields}),
            item["place"],
            tuple(item["position"]),
            float(item["turn"]),
        )
        for item in json.loads(text)["objects"]
    ]
