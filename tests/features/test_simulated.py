"""The features of simulated trials, measured: detection, position, color and shape of both experiments."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from sklearn.model_selection import LeaveOneGroupOut, cross_val_predict
from sklearn.neighbors import KNeighborsClassifier, NearestCentroid

from data_collection.log.mcap_log import read_log
from data_collection.log.truth import Truth, truth
from features.extraction_settings import FeatureSettings
from features.percept_data import Percepts
from features.percepts import perceive
from features.table import FeatureTable
from features.transforms import apply, fit_transforms
from tests.conftest import Simulated

pytestmark = pytest.mark.slow
Record = Callable[[str, object], None]


@dataclass(frozen=True)
class Expected:
    """Least shares of trials, objects and objects that must be right, and largest errors of position in metres."""

    components: int
    exact: float
    color: float
    shape: float
    median: float
    largest: float


EXPECTED = {
    "simulator": Expected(30, 0.995, 0.99, 0.95, 0.005, 0.015),
    "real": Expected(65, 0.97, 0.95, 0.85, 0.01, 0.04),
}


@dataclass(frozen=True)
class Measured:
    """What was seen, and what there was."""

    expected: Expected
    percepts: Percepts
    table: FeatureTable
    truths: dict[int, Truth]


@pytest.fixture(scope="module")
def measured(simulated: Simulated) -> Measured:
    expected = EXPECTED[simulated.experiment]
    logs = [read_log(path) for path in simulated.trials()]
    known = {int(log.metadata["trial"]): truth(log) for log in logs}
    settings = FeatureSettings.model_validate(
        {"components": expected.components, "detection": {"on_wrong_count": "drop"}}
    )
    percepts = perceive(logs, simulated.calibration(), settings)
    table = apply(fit_transforms(percepts, settings, 3), percepts)
    return Measured(expected, percepts, table, {trial: each for trial, each in known.items() if each is not None})


def matched(measured: Measured) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """Trial, positions seen, and true positions nearest to them."""
    for row, trial in enumerate(measured.percepts.trial):
        seen = measured.percepts.position[measured.percepts.trial_index == row]
        true = measured.truths[int(trial)].positions
        nearest = np.linalg.norm(seen[:, None] - true[None], axis=2).argmin(axis=1)
        yield int(trial), seen, true[nearest]


def test_every_object_is_found_and_none_invented(measured: Measured, record_property: Record) -> None:
    exact = sum(
        len(seen) == len(measured.truths[trial].positions) == len(np.unique(true, axis=0))
        for trial, seen, true in matched(measured)
    )
    share = exact / len(measured.truths)
    record_property("trials with every object found and none invented", share)
    assert share >= measured.expected.exact


def test_positions_are_where_the_objects_stand(measured: Measured, record_property: Record) -> None:
    error = np.concatenate([np.linalg.norm(seen - true, axis=1) for _, seen, true in matched(measured)])
    record_property(
        "error of position, mm, median and 99 %", (1000 * np.quantile(error, (0.5, 0.99))).round(1).tolist()
    )
    assert np.median(error) <= measured.expected.median
    assert np.quantile(error, 0.99) <= measured.expected.largest


def test_the_robot_attends_to_what_it_looks_at(measured: Measured) -> None:
    for trial, seen, _ in matched(measured):
        known = measured.truths[trial]
        index = int(measured.percepts.attended_object[list(measured.percepts.trial).index(trial)])
        assert np.linalg.norm(seen[index] - known.positions[known.attended]) < 0.05, trial


def test_color_is_told_by_the_histogram(measured: Measured, record_property: Record) -> None:
    words = np.array(measured.table.truth_color)
    training = measured.table.trial_index < len(measured.truths) // 2
    model = NearestCentroid().fit(measured.table.color[training], words[training])
    share = float((model.predict(measured.table.color[~training]) == words[~training]).mean())
    record_property("colors told right", share)
    assert share >= measured.expected.color


def test_shape_is_told_by_other_objects_of_the_type(measured: Measured, record_property: Record) -> None:
    words = np.array(measured.table.truth_object)
    objects = [f"{word} {color}" for word, color in zip(words, measured.table.truth_color or (), strict=True)]
    told = cross_val_predict(
        KNeighborsClassifier(3), measured.table.object_feature, words, groups=objects, cv=LeaveOneGroupOut()
    )
    record_property("shapes told right, 3 nearest neighbours", float((told == words).mean()))
    assert (told == words).mean() >= measured.expected.shape


COST = """
import json, sys, time
from pathlib import Path
from data_collection.log.mcap_log import read_log
from features.percepts import perceive
from features.extraction_settings import FeatureSettings
from features.transforms import apply, fit_transforms

folder, settings = Path(sys.argv[1]), FeatureSettings()
logs = (read_log(path) for path in sorted(folder.glob("trial_*.mcap"))[:40])
percepts = perceive(logs, read_log(folder / "calibration.mcap"), settings)
apply(fit_transforms(percepts, settings, 1), percepts)
# Not ru_maxrss, which begins with what the process that started this one held.
[peak] = [line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM:")]
told = {"objects": len(percepts.box), "seconds": time.process_time(), "MiB": int(peak) / 1024}
print(json.dumps(told))
"""


def test_forty_trials_cost_little(simulated: Simulated, record_property: Record) -> None:
    """From logs to tables in 15 s on two cores at most: 30 s of processor time, imports included; 1.5 GiB."""
    root = Path(__file__).parents[2]
    run = subprocess.run(
        [sys.executable, "-c", COST, str(simulated.folder)], check=True, cwd=root, capture_output=True, text=True
    )
    cost = json.loads(run.stdout)
    record_property("cost of 40 trials", {name: round(value, 1) for name, value in cost.items()})
    assert cost["objects"] >= 60
    assert cost["seconds"] <= 30
    assert cost["MiB"] <= 1536
