"""From logs to percepts: what is perceived, what may not leak in, what is refused."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from data_collection.log import codec, topics
from data_collection.log.mcap_log import Log, LogError, read_log, write_log
from data_collection.log.trial import observation
from features.arrays import ArtifactError
from features.extraction_settings import FeatureSettings
from features.percept_data import Percepts, first, join, load_percepts, only, save_percepts
from features.percepts import DetectionError, perceive, with_action
from features.transforms import apply, fit_transforms, relative_hand

if TYPE_CHECKING:
    from pathlib import Path

SETTINGS = FeatureSettings()
DROP = FeatureSettings.model_validate({"detection": {"on_wrong_count": "drop"}})


def same(one: Percepts, other: Percepts, *, but: tuple[str, ...] = ()) -> bool:
    return all(
        np.array_equal(value, getattr(other, name))
        if isinstance(value, np.ndarray)
        else value == getattr(other, name)
        for name, value in vars(one).items()
        if name not in but
    )


def without_truth(log: Log) -> Log:
    kept = tuple(m for m in log.messages if not m.topic.startswith(topics.TRUTH_PREFIX))
    return replace(log, messages=kept)


@pytest.fixture(scope="module")
def percepts(logs: Any) -> Percepts:
    return perceive(logs.trials(8), logs.calibration(), SETTINGS)


def test_perceives_what_is_there(percepts: Percepts, logs: Any) -> None:
    assert percepts.trial.tolist() == list(range(1, 9))
    assert percepts.acted.all()
    assert percepts.fc6.shape == (len(percepts.box), 4096)
    assert percepts.fc6.min() >= 0
    assert (percepts.fc6.std(axis=1) > 0).all()
    assert percepts.words[2] == ()
    assert percepts.words[0][0] == "touch"
    # truth and detections belong together: the color word is the one that the pixels show
    mean = np.array([percepts.pixels[percepts.pixel_index == i].mean(axis=0) for i in range(len(percepts.box))])
    assert tuple(np.array(["red", "green", "blue"])[mean.argmax(axis=1)]) == percepts.truth_color
    np.testing.assert_allclose(relative_hand(percepts), [[0.01, 0.0, 0.03]] * 8, atol=0.012)


def test_deleting_the_truth_changes_nothing_but_the_truth(percepts: Percepts, logs: Any) -> None:
    blind = perceive(map(without_truth, logs.trials(8)), logs.calibration(), SETTINGS)
    truth = ("truth_action", "truth_position", "truth_object", "truth_color")
    assert all(getattr(blind, name) is None for name in truth)
    assert all(getattr(percepts, name) is not None for name in truth)
    assert same(blind, percepts, but=truth)


def test_the_gaze_tells_the_attended_object_whatever_the_truth_says(logs: Any) -> None:
    log = next(log for log in logs.trials(8) if len(json.loads(scene_of(log))["objects"]) == 3)
    expected = perceive([without_truth(log)], logs.calibration(), SETTINGS).attended_object
    for attended in range(3):
        told = changed(log, topics.TRUTH_SCENE, json.dumps(json.loads(scene_of(log)) | {"attended": attended}))
        assert perceive([told], logs.calibration(), SETTINGS).attended_object == expected


def scene_of(log: Log) -> str:
    return next(str(m.value) for m in log.messages if m.topic == topics.TRUTH_SCENE)


def test_an_instruction_has_no_action_and_its_object_is_truth_only(logs: Any) -> None:
    instructions = logs.trials(4, acted=False)
    seen = perceive(instructions, logs.calibration(), SETTINGS)
    assert not seen.acted.any()
    assert (seen.attended_object >= 0).all()
    blind = perceive(map(without_truth, instructions), logs.calibration(), SETTINGS)
    assert (blind.attended_object == -1).all()


def test_order_of_logs_does_not_matter(percepts: Percepts, logs: Any) -> None:
    assert same(perceive(reversed(logs.trials(8)), logs.calibration(), SETTINGS), percepts)


def test_first_and_join_undo_each_other(percepts: Percepts) -> None:
    start = first(percepts, 5)
    assert start.trial.tolist() == [1, 2, 3, 4, 5]
    assert len(start.box) == int((percepts.trial_index < 5).sum())
    assert len(start.pixels) == int((percepts.pixel_index < len(start.box)).sum())
    assert same(join([start]), start)
    with pytest.raises(ValueError, match="D is 9; expected 1 to 8"):
        first(percepts, 9)


def test_one_trial_is_what_is_seen_of_it_alone(percepts: Percepts, logs: Any) -> None:
    for number in (1, 5, 8):
        assert same(only(percepts, number), perceive(logs.trials(1, first=number), logs.calibration(), SETTINGS))
    with pytest.raises(ValueError, match="there is no trial 9"):
        only(percepts, 9)


def test_an_action_in_a_scene_that_was_seen_is_that_of_the_trial(percepts: Percepts, logs: Any) -> None:
    (log,) = logs.trials(1, first=3)
    trial = only(percepts, 3)
    blank = {name: np.zeros_like(getattr(trial, name)) for name in ("hand", "finger_rate", "joints", "touch")}
    before = replace(trial, attended_object=np.array([-1]), acted=np.array([False]), **blank)
    assert same(with_action(before, observation(log)), trial)
    (instruction,) = logs.trials(1, acted=False)
    with pytest.raises(ValueError, match="no action was executed"):
        with_action(before, observation(instruction))


def test_blocks_join_to_the_whole(percepts: Percepts, logs: Any) -> None:
    blocks = [
        perceive(logs.trials(count, first=start), logs.calibration(), SETTINGS) for start, count in ((4, 5), (1, 3))
    ]
    joined = join(blocks)
    assert same(joined, percepts)  # to the last bit: how trials are shared out among jobs must not show
    with pytest.raises(ValueError, match=r"trials \[1, 2, 3\] occur more than once"):
        join([blocks[1], percepts])
    other = replace(blocks[0], joint_lower=blocks[0].joint_lower - 1)
    with pytest.raises(ValueError, match="joint_lower differ"):
        join([blocks[1], other])


def test_saved_percepts_load_the_same_and_have_the_same_bytes(percepts: Percepts, tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("one.npz", "two.npz")]
    for path in paths:
        save_percepts(path, percepts)
    assert len({hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}) == 1
    assert same(load_percepts(paths[0]), percepts)


def test_attempts_are_kept_where_they_are_known(percepts: Percepts, logs: Any, tmp_path: Path) -> None:
    """Of trials that are taken as they come the file says nothing of them, as before there were fair test sets."""

    def tried(log: Log, attempts: int) -> Log:
        (outcome,) = (json.loads(str(m.value)) for m in log.messages if m.topic == topics.TRUTH_OUTCOME)
        return changed(log, topics.TRUTH_OUTCOME, json.dumps(outcome | {"attempts": attempts}))

    made = [tried(log, 3 * trial) for trial, log in enumerate(logs.trials(3), start=1)]
    seen = perceive(made, logs.calibration(), SETTINGS)
    assert seen.truth_attempts is not None
    assert seen.truth_attempts.tolist() == [3, 6, 9]
    save_percepts(tmp_path / "a.npz", seen)
    assert same(load_percepts(tmp_path / "a.npz"), seen)
    assert same(first(seen, 2), first(percepts, 2), but=("truth_attempts",))
    later = perceive(logs.trials(2, first=4), logs.calibration(), SETTINGS)
    joined = join([later, seen]).truth_attempts
    assert joined is not None
    assert joined.tolist() == [3, 6, 9, 0, 0]
    kept = only(seen, 2).truth_attempts
    assert kept is not None
    assert kept.tolist() == [6]
    save_percepts(tmp_path / "b.npz", later)
    with np.load(tmp_path / "b.npz") as stored:
        assert "truth_attempts" not in stored.files


@pytest.mark.parametrize("damage", ["missing", "truncated", "flipped", "other"])
def test_damaged_percepts_are_refused(percepts: Percepts, tmp_path: Path, damage: str) -> None:
    path = tmp_path / "percepts.npz"
    save_percepts(path, percepts)
    content = bytearray(path.read_bytes())
    if damage == "missing":
        path.unlink()
    elif damage == "truncated":
        path.write_bytes(content[:-100])
    elif damage == "flipped":
        content[len(content) // 2] ^= 1
        path.write_bytes(content)
    else:
        np.savez(path, kind=np.array("transforms"))
    reason = "holds transforms; expected percepts" if damage == "other" else "no such file|truncated or damaged"
    with pytest.raises(ArtifactError, match=rf"percepts\.npz: .*({reason})"):
        load_percepts(path)


def crowded(logs: Any) -> Log:
    log: Log = logs.trials(1)[0]
    image = logs.scene.empty().copy()
    for column in (40, 100, 160, 220, 280):
        image[100:130, column - 12 : column + 12] = (200, 30, 30)
    return changed(log, topics.IMAGE_BEFORE, image)


def changed(log: Log, topic: str, value: Any) -> Log:
    return replace(log, messages=tuple(replace(m, value=value) if m.topic == topic else m for m in log.messages))


def test_a_wrong_count_is_an_error_that_names_the_trial(logs: Any) -> None:
    with pytest.raises(DetectionError, match="trial 1: 5 objects found; expected 1 to 3"):
        perceive([crowded(logs)], logs.calibration(), SETTINGS)
    empty = changed(logs.trials(1)[0], topics.IMAGE_BEFORE, logs.scene.empty())
    with pytest.raises(DetectionError, match="trial 1: 0 objects found; expected 1 to 3"):
        perceive([empty], logs.calibration(), SETTINGS)


def test_a_wrong_count_is_dropped_and_counted_where_so_set(
    logs: Any, percepts: Percepts, caplog: pytest.LogCaptureFixture
) -> None:
    rest = logs.trials(8)[1:]
    seen = perceive([crowded(logs), *rest], logs.calibration(), DROP)
    assert seen.trial.tolist() == list(range(2, 9))
    assert seen.dropped == ("trial 1: 5 objects found; expected 1 to 3 (feature_extraction.detection)",)
    assert "dropped: trial 1" in caplog.text
    np.testing.assert_array_equal(seen.position, percepts.position[percepts.trial_index > 0])
    assert seen.dropped_trial.tolist() == [1]
    assert first(seen, 3).trial.tolist() == [2, 3], "a dropped trial counts among the first D"
    assert first(seen, 8).dropped == seen.dropped
    with pytest.raises(ValueError, match="none of the first 1 trials is left\ntrial 1: 5 objects"):
        first(seen, 1)


def test_a_block_of_which_no_trial_is_left_is_joined_to_others(logs: Any, tmp_path: Path) -> None:
    """How trials are shared out among jobs must not show: alone in its block, a dropped trial stops nothing."""
    full = crowded(logs)
    whole = perceive([full, *logs.trials(3)[1:]], logs.calibration(), DROP)
    save_percepts(tmp_path / "gone.npz", perceive([full], logs.calibration(), DROP))
    gone = load_percepts(tmp_path / "gone.npz")
    assert (len(gone.trial), gone.dropped_trial.tolist()) == (0, [1])
    rest = perceive(logs.trials(3)[1:], logs.calibration(), DROP)
    assert same(join([rest, gone]), whole)
    transforms = fit_transforms(join([gone, rest]), DROP, 1, "own", 3)
    with pytest.raises(ValueError, match="no trial is left\ntrial 1: 5 objects found"):
        apply(transforms, gone)


def test_logs_that_say_the_same_trial_are_both_named(logs: Any) -> None:
    first_, second = (replace(log, source=f"trial_000{i}.mcap") for i, log in enumerate(logs.trials(2), start=1))
    for number in ("1", "0001"):
        again = replace(second, metadata={**second.metadata, "trial": number})
        with pytest.raises(
            LogError, match=r"trial_0002\.mcap: says that it is trial 1, and so does trial_0001\.mcap"
        ):
            perceive([first_, again], logs.calibration(), SETTINGS)
    turned = [replace(log, metadata={"trial": str(3 - i)}) for i, log in enumerate((first_, second), start=1)]
    for given in (turned, turned[::-1]):
        with pytest.raises(
            LogError, match=r"trial_0002\.mcap: says that it is trial 1, and trial_0001\.mcap before it"
        ):
            perceive(given, logs.calibration(), SETTINGS)
    later = [replace(log, metadata={"trial": str(100 + i)}) for i, log in enumerate((first_, second), start=1)]
    assert perceive(later[::-1], logs.calibration(), SETTINGS).trial.tolist() == [101, 102]


def test_dropped_trials_stay_known(logs: Any, tmp_path: Path) -> None:
    """In the artifact, in a block that is joined to others, and not among the first D before it."""
    early = perceive(logs.trials(2), logs.calibration(), DROP)
    full = changed(logs.trials(1, first=4)[0], topics.IMAGE_BEFORE, scene_image(crowded(logs)))
    late = perceive([full, *logs.trials(1, first=3), *logs.trials(1, first=5)], logs.calibration(), DROP)
    save_percepts(tmp_path / "late.npz", late)
    joined = join([load_percepts(tmp_path / "late.npz"), early])
    assert joined.trial.tolist() == [1, 2, 3, 5]
    assert joined.dropped_trial.tolist() == [4]
    assert first(joined, 3).dropped == ()
    assert (first(joined, 4).trial.tolist(), first(joined, 4).dropped) == ([1, 2, 3], late.dropped)


def scene_image(log: Log) -> Any:
    return next(m.value for m in log.messages if m.topic == topics.IMAGE_BEFORE)


def test_a_corrupt_image_in_a_log_is_refused_by_name(logs: Any, tmp_path: Path) -> None:
    path = tmp_path / "trial_0001.mcap"
    write_log(path, logs.trials(1)[0])
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0xFF
    path.write_bytes(content)
    with pytest.raises(LogError, match=r"trial_0001\.mcap"):
        perceive((read_log(p) for p in [path]), logs.calibration(), SETTINGS)


def test_an_image_that_is_no_image_is_refused_by_name(
    logs: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The log itself is sound: it was written with a picture that somebody's recorder had spoilt."""
    monkeypatch.setattr(codec, "encode_png", lambda image: b"\x89PNG and no more")
    write_log(tmp_path / "trial_0001.mcap", logs.trials(1)[0])
    with pytest.raises(LogError, match=r"trial_0001\.mcap: /camera/before/compressed at 0 ns cannot be decoded"):
        read_log(tmp_path / "trial_0001.mcap")


def test_an_image_of_another_size_is_refused(logs: Any) -> None:
    small = np.zeros((120, 160, 3), dtype=np.uint8)
    log = changed(logs.trials(1)[0], topics.IMAGE_BEFORE, small)
    with pytest.raises(LogError, match=r"before/compressed has 160 × 120 pixels, but .* for pictures of 320 × 240"):
        perceive([log], logs.calibration(), SETTINGS)
    pictures = (topics.IMAGE_BEFORE, topics.IMAGE_GAZE, topics.IMAGE_AFTER)
    for topic in pictures:  # all of them, and the camera
        log = changed(log, topic, small)
    camera: Any = next(m.value for m in log.messages if m.topic == topics.CAMERA)
    log = changed(log, topics.CAMERA, replace(camera, width=160, height=120))
    with pytest.raises(ValueError, match=r"trial 1: images of shapes \(120, 160, 3\) and \(240, 320, 3\)"):
        perceive([log], logs.calibration(), SETTINGS)
