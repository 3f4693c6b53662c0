"""Trials to count outcomes of, with the pins of jobs: `python -m tests.simulate EXPERIMENT FOLDER COUNT < SETTINGS`.

In a process of its own, since glibc reads its pins when one begins; so the trials are the same on every processor.
"""

from __future__ import annotations

import sys
from pathlib import Path

from data_collection.episode import calibrate, collect
from data_collection.log.mcap_log import write_log
from data_collection.processor import begin_pinned
from data_collection.simulation_settings import Simulation


def main(simulation: Simulation, experiment: str, folder: Path, count: int) -> None:
    """Write the logs of trials 1 to `count` and of the calibration."""
    # The seed is one that nothing was developed on.
    seed, provenance = 2017, dict[str, str]()
    trials = range(1, count + 1)
    for i, log in enumerate(
        collect(simulation, experiment=experiment, seed=seed, provenance=provenance, set_name="train", trials=trials)
    ):
        write_log(folder / f"trial_{i + 1:04}.mcap", log)
    write_log(
        folder / "calibration.mcap", calibrate(simulation, experiment=experiment, seed=seed, provenance=provenance)
    )


if __name__ == "__main__":
    begin_pinned()
    main(Simulation.model_validate_json(sys.stdin.read()), sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))
