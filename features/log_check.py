"""What a study needs to know of a log before it begins: whether it can be perceived, and what it says."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from data_collection.log.mcap_log import LogError, read_log
from data_collection.log.trial import calibration, observation
from data_collection.log.truth import truth
from features.extraction_settings import Detection
from features.homography import CalibrationError
from features.percepts import found_objects
from features.view import View, fit_view


@dataclass(frozen=True)
class CheckedLog:
    """What a sound log of a trial says. It depends on the file's content, not on its name.

    Attributes:
        said_number: The number that the log gives its trial; None where it gives none.
        words: The sentence.
        objects: How many objects are seen before the action.
        limits: sha256 of the joints' limits, which are the same in all logs of an experiment.
        truth_action, truth_position, truth_object, truth_color: The true words, for evaluation; may be empty.
    """

    said_number: int | None
    words: tuple[str, ...]
    objects: int
    limits: str
    truth_action: tuple[str, ...] = ()
    truth_position: tuple[str, ...] = ()
    truth_object: tuple[str, ...] = ()
    truth_color: tuple[str, ...] = ()


def open_calibration(path: Path) -> View:
    """Return the view that a calibration log gives.

    Raises:
        LogError: The log is damaged, incomplete, of another kind, or its picture does not show the dots.
    """
    try:
        return fit_view(calibration(read_log(path)))
    except CalibrationError as error:
        raise LogError(f"{path}: {error}") from error


def check_log(path: Path, view: View, settings: Detection, *, need_action: bool) -> CheckedLog:
    """Open a log as a study will, and say what it holds.

    Args:
        path: File of a trial or an instruction.
        view: The view of its experiment.
        settings: How objects are found.
        need_action: Whether an action must have been executed.

    Raises:
        LogError: The log is damaged, incomplete or of another kind, or its picture has another size.
    """
    log = read_log(path)
    seen, known = observation(log), truth(log)
    if need_action and seen.gaze_target is None:
        raise LogError(f"{path}: is the log of an instruction, without an action; this set needs actions")
    try:
        found = found_objects(seen, view, settings)
    except ValueError as error:
        raise LogError(f"{path}: {error}") from error
    limits = hashlib.sha256(seen.joint_lower.tobytes() + seen.joint_upper.tobytes()).hexdigest()
    said = seen.trial if "trial" in log.metadata else None
    truth_words = known and ((known.action_word,), known.place_words, known.object_words, known.color_words)
    return CheckedLog(said, seen.words, len(found), limits, *(truth_words or ()))
