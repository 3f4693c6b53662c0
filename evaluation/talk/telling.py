"""What a robot understood and did, as text for a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from evaluation.talk.understanding import MOST_FRAMED, Understanding, Word
from features.table import FeatureTable
from model import Method

if TYPE_CHECKING:  # what is understood is told before the simulation is loaded
    from evaluation.talk.acting import Deed

MOST_CATEGORIES = 4
"""So many action categories are told, the most probable ones."""


def told(understood: Understanding, table: FeatureTable, row: int, method: Method) -> Iterator[str]:
    """Lines that say what a robot makes of a sentence.

    Args:
        understood: What it makes of it.
        table: The features of scenes.
        row: Of the scene.
        method: What the robot learned by.
    """
    yield f"heard: {understood.sentence or '(nothing)'}"
    width = max((len(word.text) for word in understood.words), default=0)
    for word in understood.words:
        yield f"  {word.text:{width}}  {_channel(word, method)}"
    yield "object:"
    places = table.position[table.trial_index == row]
    for m, probability in enumerate(understood.objects):
        mark = "  ← this one" if m in understood.chosen else ""
        yield f"  {m + 1}  {_per_cent(probability)}  at x {places[m][0]:.2f} m, y {places[m][1]:.2f} m{mark}"
    yield "action:"
    for k in np.argsort(-understood.categories, kind="stable")[:MOST_CATEGORIES]:
        yield f"  category {k:2}  {_per_cent(understood.categories[k])}  says “{understood.labels[k]}”"


def done(deed: Deed) -> Iterator[str]:
    """Lines that say what a robot did, in the tutor's and in its own words."""
    yield f"did: something to object {deed.attended + 1}"
    yield f"the tutor saw: {deed.tutor or 'nothing'}{_outcome(deed)}"
    yield f"the robot says: {' '.join(deed.described.values())}"


def _outcome(deed: Deed) -> str:
    told = [
        text
        for text, true in (
            ("it touched the object", deed.outcome.get("contact")),
            ("it held the object", deed.outcome.get("held")),
            ("it knocked over another one", deed.outcome.get("toppled")),
        )
        if true
    ]
    return f" ({', '.join(told)})" if told else ""


def _channel(word: Word, method: Method) -> str:
    if not word.known:
        return "unknown: the robot never heard it, and leaves it out"
    if word.channels is None:
        too_many = f"the channels of more than {MOST_FRAMED} known words are not told"
        return too_many if method.has_frames else f"every channel explains it: {method.label} has no frames"
    name, probability = max(word.channels.items(), key=lambda one: one[1])
    others = [f"{other} {share:.0%}" for other, share in word.channels.items() if other != name]
    return f"{name:8} {_per_cent(probability)}  ({', '.join(others)})"


def _per_cent(probability: float) -> str:
    return f"{probability:6.1%}"
