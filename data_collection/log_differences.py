"""Whether two logs say the same, and simulating a log again from its own metadata."""

import json
from collections.abc import Mapping
from typing import Any

from data_collection.episode import SETS, calibrate, collect, execute
from data_collection.limits import MAX_TRIAL
from data_collection.log.mcap_log import Log, LogError
from data_collection.log.messages import same
from data_collection.simulation_settings import Simulation
from data_collection.task import Command

_OWN_KEYS = ("experiment", "set", "trial", "seed", "settings")


def differences(first: Log, second: Log) -> list[str]:
    """Return where two logs differ: metadata, topics, times, every number and pixel; empty if nowhere."""
    found = [
        f"metadata {key}: {first.metadata.get(key)!r} and {second.metadata.get(key)!r}"
        for key in sorted({*first.metadata, *second.metadata})
        if first.metadata.get(key) != second.metadata.get(key)
    ]
    if len(first.messages) != len(second.messages):
        found.append(f"{len(first.messages)} and {len(second.messages)} messages")
    for one, other in zip(first.messages, second.messages, strict=False):
        if (one.topic, one.time) != (other.topic, other.time):
            found.append(f"{one.topic} at {one.time} ns and {other.topic} at {other.time} ns")
            break
        if not same(one.value, other.value):
            found.append(f"{one.topic} at {one.time} ns: values differ")
    return found


def regenerate(log: Log) -> Log:
    """Simulate the trial of a log again from the settings, seed and names in its metadata.

    Raises:
        LogError: The log is not from the simulator, or its settings do not fit this version.
    """
    missing = [key for key in _OWN_KEYS if key not in log.metadata]
    if missing:
        raise LogError(
            f"{log.source}: metadata lacks {', '.join(missing)}: only logs of the simulator can be simulated again"
        )
    try:
        simulation = Simulation.model_validate(json.loads(log.metadata["settings"]))
        seed, trial = int(log.metadata["seed"]), int(log.metadata["trial"])
        commands = [Command(**json.loads(log.metadata["command"]))] if "command" in log.metadata else []
        is_trial = log.metadata["set"] in SETS
        if not is_trial and log.metadata["set"] != "calibration":
            raise ValueError(f"set {log.metadata['set']!r} is none of {', '.join(SETS)}, calibration")
        if seed < 0 or not int(is_trial) <= trial <= MAX_TRIAL:
            raise ValueError(f"seed {seed}, trial {trial}: from 0, and from 1 to {MAX_TRIAL:,}, are expected")
    except (ValueError, TypeError, RecursionError) as error:
        raise LogError(f"{log.source}: its metadata do not fit this version:\n{error}") from error
    try:
        return _simulated(log, simulation, seed, trial, commands)
    except Exception as error:  # what a stranger's settings break surfaces as errors of the simulator, of NumPy, …
        raise LogError(
            f"{log.source}: cannot be simulated again from its metadata ({type(error).__name__}: {error})"
        ) from error


def _simulated(log: Log, simulation: Simulation, seed: int, trial: int, commands: list[Command]) -> Log:
    set_name = log.metadata["set"]
    told: Any = {"experiment": log.metadata["experiment"], "seed": seed, "provenance": _provenance(log.metadata)}
    if set_name == "calibration":
        return calibrate(simulation, **told)
    if commands:
        return next(execute(simulation, set_name=set_name, commands=commands, **told))
    return next(collect(simulation, set_name=set_name, trials=[trial], **told))


def _provenance(metadata: Mapping[str, str]) -> dict[str, str]:
    derived = {*_OWN_KEYS, "settings_sha256", "joint_names", "tactile_names", "units", "command"}
    return {key: value for key, value in metadata.items() if key not in derived}
