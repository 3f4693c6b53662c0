"""What whoever simulated or annotated a log knows more than the robot; for evaluation only."""

import json
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from data_collection.limits import MAX_TRIAL, WORD_RULE, is_word, normal
from data_collection.log import topics
from data_collection.log.mcap_log import Log, LogError
from data_collection.log.messages import Floats


@dataclass(frozen=True)
class Truth:
    """What the simulator, or whoever annotated the log, knows; for evaluation only.

    Attributes:
        object_words: Word of the object channel of each of the M objects.
        color_words: Word of the color channel of each.
        place_words: Word of the position channel of each.
        positions: (M, 2) metres ahead and left, before the action.
        attended: Index of the object that was acted on, or that the instruction means.
        action_word: Word for what happened, or what the instruction demands.
        outcome: What physically happened: `action`, `contact`, `held`, `rise`, `hand_error`, `toppled`;
            in an instruction only `action` and `word`.
        attempts: How often the trial was tried until the tutor said the word that was due in a fair test set; None
            where a trial is taken as it comes.
    """

    object_words: tuple[str, ...]
    color_words: tuple[str, ...]
    place_words: tuple[str, ...]
    positions: Floats
    attended: int
    action_word: str
    outcome: Mapping[str, Any]
    attempts: int | None = None


def truth(log: Log) -> Truth | None:
    """Return the truth of a log, or None when it has no truth topics.

    Raises:
        LogError: The truth is not as documented, or only some of it is there. Other topics are not looked at.
    """
    last = {message.topic: message.value for message in log.messages}
    scene, outcome = last.get(topics.TRUTH_SCENE), last.get(topics.TRUTH_OUTCOME)
    if scene is None and outcome is None:
        return None
    if not isinstance(scene, str) or not isinstance(outcome, str):
        missing = topics.TRUTH_OUTCOME if outcome is None else topics.TRUTH_SCENE
        raise LogError(f"{log.source}: {missing} is missing while other truth is there")
    try:
        known, happened = json.loads(scene), json.loads(outcome)
        objects = known["objects"]
        result = Truth(
            object_words=tuple(_word(item["object"]) for item in objects),
            color_words=tuple(_word(item["color"]) for item in objects),
            place_words=tuple(_word(item["place"]) for item in objects),
            positions=np.array([item["position"] for item in objects], dtype=np.float64).reshape(-1, 2),
            attended=operator.index(known["attended"]),
            action_word=_word(happened["word"]),
            outcome=happened,
            attempts=operator.index(happened["attempts"]) if "attempts" in happened else None,
        )
        if not np.isfinite(result.positions).all():
            raise ValueError("a position is not finite")
        if not 0 <= result.attended < len(objects):
            raise ValueError(f"attended is {result.attended}, there are {len(objects)} objects")
        if result.attempts is not None and not 1 <= result.attempts <= MAX_TRIAL:
            raise ValueError(f"attempts is {result.attempts}, from 1 to {MAX_TRIAL:,} are expected")
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise LogError(
            f"{log.source}: {topics.TRUTH_SCENE} or {topics.TRUTH_OUTCOME} is not as documented "
            f"({type(error).__name__}: {error})"
        ) from error
    return result


def _word(value: Any) -> str:
    """Return a word, in the form in which words are compared; raises ValueError when it is none."""
    if not (isinstance(value, str) and is_word(value)):
        raise ValueError(f"{str(value)[:60]!r} is no word ({WORD_RULE})")
    return normal(value)
