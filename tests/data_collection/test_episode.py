import dataclasses
import hashlib
import itertools
import multiprocessing
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from data_collection import exam
from data_collection.design import target
from data_collection.episode import calibrate, collect, execute
from data_collection.joints import JOINT_NAMES
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError, read_log, write_log
from data_collection.log.messages import JointState
from data_collection.log.trial import observation
from data_collection.log.truth import truth
from data_collection.log_differences import differences, regenerate
from data_collection.simulation_settings import Simulation
from data_collection.simulator.recording import Sample
from data_collection.simulator.world import World
from data_collection.task import Command, Judgement, Placed, judge
from tests.conftest import Simulated, simulation_of

PROVENANCE = {"code_sha256": "c0de", "lock_sha256": "10c4"}


def _bytes(log: Log, path: Path) -> bytes:
    write_log(path, log)
    return path.read_bytes()


def _one(simulation: Simulation, set_name: str, trial: int, seed: int = 1) -> Log:
    made = collect(
        simulation, experiment="simulator", set_name=set_name, trials=[trial], seed=seed, provenance=PROVENANCE
    )
    return next(made)


def test_who_watches_sees_every_sample_and_changes_nothing(simulation: Simulation, executed: Log) -> None:
    command = Command(trial=1, gaze=(0.3, 0.0), target=None, finger_rate=0.0)
    seen: list[Sample] = []
    (log,) = execute(
        simulation, experiment="simulator", seed=1, commands=[command], provenance=PROVENANCE, watch=seen.append
    )
    assert differences(log, executed) == []
    logged = [message for message in log.messages if message.topic == topics.TRUTH_POSES]
    assert [sample.time for sample in seen] == [message.time for message in logged]
    assert all(np.array_equal(s.objects, np.asarray(m.value)) for s, m in zip(seen, logged, strict=True))


def test_a_trial_does_not_depend_on_those_before_it(
    simulation: Simulation, trials: list[Log], tmp_path: Path
) -> None:
    alone = _one(simulation, "train", 4)
    assert differences(trials[3], alone) == []
    assert _bytes(trials[3], tmp_path / "a") == _bytes(alone, tmp_path / "b")


def test_seed_set_and_trial_all_matter(simulation: Simulation, trials: list[Log]) -> None:
    scenes = {str(m.value) for log in trials for m in log.messages if m.topic == topics.TRUTH_SCENE}
    for other in (_one(simulation, "description", 1), _one(simulation, "train", 1, seed=2)):
        scenes |= {str(m.value) for m in other.messages if m.topic == topics.TRUTH_SCENE}
    assert len(scenes) == len(trials) + 2


@pytest.mark.parametrize("kind", ["trial", "instruction", "calibration", "executed", "real"])
def test_regenerated_from_its_own_metadata(kind: str, request: pytest.FixtureRequest, trials: list[Log]) -> None:
    names = {
        "calibration": "calibration_log",
        "real": "real_trial",
        "instruction": "instruction",
        "executed": "executed",
    }
    log: Log = trials[1] if kind == "trial" else request.getfixturevalue(names[kind])
    assert differences(log, regenerate(log)) == []


def test_regenerate_needs_the_simulators_metadata(trials: list[Log]) -> None:
    with pytest.raises(LogError, match=r"robot\.mcap: metadata lacks .*settings"):
        regenerate(dataclasses.replace(trials[0], metadata={"trial": "1"}, source="robot.mcap"))
    bad = {**trials[0].metadata, "settings": '{"lens": 1}'}
    with pytest.raises(LogError, match="lens"):
        regenerate(dataclasses.replace(trials[0], metadata=bad))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("set", "exam"),
        ("trial", "-1"),
        ("trial", "0"),
        ("trial", "one"),
        ("seed", "-1"),
        ("command", '{"trial": 1}'),
        ("command", '{"trial": 1, "gaze": [0.3], "target": null, "finger_rate": 0.5}'),
        ("command", '{"trial": 1, "gaze": ["a", "b"], "target": null, "finger_rate": 0.5}'),
        ("command", '{"trial": 1, "gaze": [0.3, NaN], "target": null, "finger_rate": 0.5}'),
        ("command", '{"trial": 1, "gaze": [0.3, 0.0], "target": [0.3, 0.0], "finger_rate": 0.5}'),
        ("command", '{"trial": 1, "gaze": [0.3, 0.0], "target": null, "finger_rate": 2.0}'),
        ("command", '{"trial": 0, "gaze": [0.3, 0.0], "target": null, "finger_rate": 0.5}'),
    ],
)
def test_regenerate_names_metadata_that_are_none(trials: list[Log], key: str, value: str) -> None:
    with pytest.raises(LogError, match=r"robot\.mcap: its metadata do not fit"):
        regenerate(dataclasses.replace(trials[0], metadata={**trials[0].metadata, key: value}, source="robot.mcap"))


def test_metadata(trials: list[Log]) -> None:
    metadata = trials[2].metadata
    assert (metadata["experiment"], metadata["set"], metadata["trial"], metadata["seed"]) == (
        "simulator",
        "train",
        "3",
        "1",
    )
    assert metadata["code_sha256"] == "c0de"
    assert metadata["joint_names"].split() == list(JOINT_NAMES)
    assert len(metadata["settings_sha256"]) == 64


def test_signals_live(trials: list[Log]) -> None:
    """Joints move, images differ, nothing is constant or not finite, the rate is the one set."""
    moved = next(log for log in trials if (known := truth(log)) and known.outcome["hand_error"] is not None)
    states = [m for m in moved.messages if m.topic == topics.JOINT_STATES]
    steps = np.diff([message.time for message in states[:-1]])
    assert steps == pytest.approx(5e7, abs=1)
    positions = np.array([m.value.position for m in states if isinstance(m.value, JointState)])
    still = [JOINT_NAMES[joint] for joint in np.flatnonzero(np.ptp(positions, axis=0) < 1e-4)]
    assert set(still) <= {"neck_roll"}
    velocities = np.array([m.value.velocity for m in states if isinstance(m.value, JointState)])
    assert np.abs(velocities).max() > 0.2
    assert np.abs(np.diff(positions[:-1], axis=0)).max() < 0.5, "nothing jumps within 50 ms"
    seen = observation(moved)
    assert seen.image_gaze is not None
    assert seen.image_after is not None
    pictures = [image.astype(int) for image in (seen.image_before, seen.image_gaze, seen.image_after)]
    assert all(np.abs(one - other).mean() > 1 for one, other in itertools.pairwise(pictures))


def test_the_robot_does_not_hide_the_table(simulation: Simulation, calibration_log: Log) -> None:
    """In the rest posture the camera sees nothing but the table where objects can be."""
    empty = np.asarray(next(m.value for m in calibration_log.messages if m.topic == topics.CALIBRATION_EMPTY))
    assert empty[20:262].min() > 200, "white table, no shadow and no arm"


@pytest.mark.parametrize("shape", ["box", "cup", "ball"])
@pytest.mark.parametrize("place", ["left"])
def test_a_good_grasp_holds(simulation: Simulation, shape: str, place: str) -> None:
    kind = next(kind for kind in simulation.kinds() if kind.shape == shape)
    with World(simulation) as world:
        world.set_up([Placed(kind, place, simulation.places[place], 0.3)], None)
        closed = world.act(0, world.best_grasp(0), 0.85, np.zeros(2), lifts=bool).outcome
        assert judge(closed, simulation) == Judgement(contact=True, held=True, action="grasp")
        assert closed.rise == pytest.approx(simulation.motion.lift_height, abs=0.01)
        world.set_up([Placed(kind, place, simulation.places[place], 0.3)], None)
        above = world.best_grasp(0) + np.array([0.0, 0.0, 0.05])
        opened = world.act(0, above, 0.0, np.zeros(2), lifts=bool).outcome
        assert judge(opened, simulation) == Judgement(contact=False, held=False, action="reach")
        assert opened.hand_error == pytest.approx(0.0, abs=0.003)


def test_touch_is_felt(simulation: Simulation) -> None:
    kind = simulation.kinds()[0]
    with World(simulation) as world:
        world.set_up([Placed(kind, "front", (0.21, 0.0), 0.3)], None)
        recording = world.act(0, world.best_grasp(0), 0.9, np.zeros(2), lifts=bool)
        first, last = recording.samples[0].touch, recording.samples[-1].touch
        assert first.max() == 0.0
        assert last.max() > 0.3
        assert ((last >= 0.0) & (last <= 1.0)).all()


def test_executed_as_commanded(simulation: Simulation, instruction: Log, executed: Log) -> None:
    known, done = truth(instruction), truth(executed)
    assert known is not None
    assert done is not None
    assert np.array_equal(known.positions, done.positions)
    assert observation(executed).words == observation(instruction).words
    assert np.array_equal(observation(executed).image_before, observation(instruction).image_before)
    assert done.outcome["action"] == "look-at"
    distance = np.linalg.norm(known.positions - [0.3, 0.0], axis=1)
    assert done.attended == distance.argmin()


def test_commands_do_not_depend_on_those_before(simulation: Simulation, executed: Log) -> None:
    """The second command of a run gives the log that it gives alone; it reaches where it is told."""
    commands = [Command(2, (0.21, 0.0), (0.25, 0.0, 0.1), 0.3), Command(1, (0.3, 0.0), None, 0.0)]
    first, second = execute(simulation, experiment="simulator", seed=1, commands=commands, provenance=PROVENANCE)
    assert differences(second, executed) == []
    hand = observation(first).hand_position
    assert np.linalg.norm(hand - [0.25, 0.0, 0.1]) < 0.03


@pytest.mark.parametrize(
    ("set_name", "numbers", "match"), [("test", [1], "train, generation"), ("train", [0], "from 1")]
)
def test_bad_requests(simulation: Simulation, set_name: str, numbers: Sequence[int], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        next(collect(simulation, experiment="e", set_name=set_name, trials=numbers, seed=1, provenance={}))


def test_noise_levels_are_settings(real: Simulation) -> None:
    """Without noise two pictures of the same scene are equal; with it they differ by its size."""
    sharp = real.camera.model_copy(update={"blur": 0.0})
    quiet = sharp.model_copy(update={"noise": 0.0})
    noisy, clean = (
        np.asarray(calibrate(each, experiment="e", seed=1, provenance={}).messages[1].value, dtype=np.float64)
        for each in (real.model_copy(update={"camera": camera}) for camera in (sharp, quiet))
    )
    assert (noisy - clean).std() == pytest.approx(real.camera.noise, rel=0.1)


def _hash(experiment: str, trial: int) -> bytes:
    simulation = simulation_of(experiment)
    made = collect(simulation, experiment=experiment, set_name="train", trials=[trial], seed=1, provenance=PROVENANCE)
    with tempfile.TemporaryDirectory() as folder:
        return hashlib.sha256(_bytes(next(made), Path(folder, "a"))).digest()


@pytest.mark.parametrize("experiment", ["simulator", "real"])
def test_the_tutor_says_in_each_test_trial_what_is_due(experiment: str, tmp_path: Path) -> None:
    """The first four trials of a set hold each action and place once; a job with one trial gives its bytes."""
    simulation = simulation_of(experiment)

    def logs(trials: Sequence[int]) -> list[Log]:
        names = {"experiment": experiment, "set_name": "description"}
        return list(collect(simulation, trials=trials, seed=1, provenance=PROVENANCE, **names))

    made = logs(range(1, 5))
    said = [known for log in made if (known := truth(log)) is not None]
    for trial, known in enumerate(said, start=1):
        due = target(simulation, experiment=experiment, set_name="description", trial=trial, seed=1)
        words = known.action_word, known.place_words[known.attended]
        assert words == (due.action, due.place)
        what = known.object_words[known.attended], known.color_words[known.attended]
        assert what == (due.kind.object, due.kind.color)
    assert {known.action_word for known in said} == set(simulation.actions.values())
    assert {known.place_words[known.attended] for known in said} == set(simulation.places)
    attempts = [known.attempts for known in said]
    assert all(count is not None and count >= 1 for count in attempts)
    assert attempts[[known.action_word for known in said].index("look-at")] == 1
    assert max(count for count in attempts if count is not None) > 1, "some were thrown away"
    (alone,) = logs([4])
    assert _bytes(alone, tmp_path / "a") == _bytes(made[3], tmp_path / "b")
    assert differences(alone, regenerate(alone)) == []


def test_training_trials_are_taken_as_they_come(trials: list[Log]) -> None:
    assert [known.attempts for log in trials if (known := truth(log)) is not None] == [None] * len(trials)


def test_a_word_that_is_never_said_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """No hand closes so far that it is a grasp to this tutor: the message says what was tried, and what decides."""
    monkeypatch.setattr(exam, "MOST_ATTEMPTS", 2)
    simulation = Simulation.model_validate({"tutor": {"contact": 5.0}, "motion": {"height_mean": 0.1}})
    due = {
        trial: target(simulation, experiment="e", set_name="description", trial=trial, seed=1)
        for trial in range(1, 5)
    }
    trial = next(number for number, one in due.items() if one.action == "grasp")
    told = (
        rf"e, description, trial {trial}: the tutor did not say 'grasp' \(grasp\) in 2 attempts with a "
        rf"{due[trial].kind.color} {due[trial].kind.object} at '{due[trial].place}'"
        r".*simulation.tutor.*simulation.motion"
    )
    with pytest.raises(ValueError, match=told):
        next(
            collect(simulation, experiment="e", set_name="description", trials=[trial], seed=1, provenance=PROVENANCE)
        )


@pytest.mark.slow
@pytest.mark.parametrize(("experiment", "size"), [("simulator", 12), ("real", 10)])
def test_sets_of_the_papers_sizes_are_fair(
    experiment: str, size: int, record_property: Callable[[str, object], None]
) -> None:
    """What the logs tell: every word of every channel is true equally often, as the tutor said."""
    simulation, kinds = simulation_of(experiment), simulation_of(experiment).kinds()
    names = {"experiment": f"{experiment}.set2", "set_name": "description"}
    made = collect(simulation, trials=range(1, size + 1), seed=1, provenance=PROVENANCE, **names)
    said = [known for log in made if (known := truth(log)) is not None]
    true = {
        "action": ([known.action_word for known in said], set(simulation.actions.values())),
        "position": ([known.place_words[known.attended] for known in said], set(simulation.places)),
        "object": ([known.object_words[known.attended] for known in said], {kind.object for kind in kinds}),
        "color": ([known.color_words[known.attended] for known in said], {kind.color for kind in kinds}),
    }
    for channel, (words, all_words) in true.items():
        counts = [words.count(word) for word in all_words]
        assert max(counts) - min(counts) <= 1, (channel, counts)
    attempts = sum(known.attempts or 0 for known in said)
    record_property("attempts thrown away", f"{attempts - size} of {attempts}")


@pytest.mark.slow
def test_same_bytes_in_one_process_and_in_four(trials: list[Log], real_trial: Log, tmp_path: Path) -> None:
    ours = [hashlib.sha256(_bytes(log, tmp_path / "a")).digest() for log in (*trials[:3], real_trial)]
    with multiprocessing.get_context("spawn").Pool(4) as pool:
        assert pool.starmap(_hash, [("simulator", 1), ("simulator", 2), ("simulator", 3), ("real", 2)]) == ours


def test_memory_does_not_grow(simulation: Simulation) -> None:
    """PyBullet never frees what it is given in some ways (lists of vertices: 0.3 MB an object)."""

    def resident() -> int:
        status = Path("/proc/self/status").read_text(encoding="ascii")
        return int(next(line.split()[1] for line in status.splitlines() if line.startswith("VmRSS")))

    with World(simulation) as world:
        scene = [
            Placed(kind, place, simulation.places[place], 0.0)
            for kind, place in zip(simulation.kinds()[::3], simulation.places, strict=False)
        ]
        assert {item.kind.shape for item in scene} == {"box", "cup", "ball"}
        for number in range(60):
            world.set_up(scene, None)
            world.picture()
            if number == 9:
                before = resident()
        assert resident() - before < 2_500, "kB over 50 set-ups"


@pytest.mark.slow
def test_what_happens_in_many_trials(simulated: Simulated, record_property: Callable[[str, object], None]) -> None:
    """Each of the four words in 15 to 40 %, hardly a bystander knocked over, the hand where it was sent."""
    known = [truth(read_log(path)) for path in simulated.trials()]
    outcomes = [each.outcome for each in known if each is not None]
    count = len(outcomes)
    shares = {
        action: sum(each["action"] == action for each in outcomes) / count for action in simulated.simulation.actions
    }
    toppled = sum(bool(each["toppled"]) for each in outcomes)
    moved = [each for each in outcomes if each["hand_error"] is not None]
    stopped = [each for each in moved if each["contact"] and each["hand_error"] > 0.002]
    errors = 1000 * np.array([each["hand_error"] for each in moved if each not in stopped])
    tried = [each for each in moved if each["contact"] and each["finger_rate"] > 0.25]
    record_property("trials", count)
    record_property("share of each action word", shares)
    record_property("hand error, mm, median and 99 %", np.quantile(errors, (0.5, 0.99)).round(2).tolist())
    record_property("moves stopped by contact, of all", f"{len(stopped)} of {len(moved)}")
    record_property("grasp attempts that hold", f"{sum(each['held'] for each in tried)} of {len(tried)}")
    record_property("trials with a knocked-over bystander", toppled)
    assert all(0.15 <= share <= 0.40 for share in shares.values()), shares
    assert toppled <= 0.01 * count
    assert np.median(errors) <= 5.0
    assert np.quantile(errors, 0.99) <= 15.0
