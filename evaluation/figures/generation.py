"""What the robot did when it was told to, in the style of the paper's Figures 5 and 9."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from data_collection.log.mcap_log import Log, read_log
from data_collection.log.messages import Image
from data_collection.log.trial import observation
from data_collection.log.truth import truth
from data_collection.show import animation
from evaluation.figures.drawing import DPI, PAGE_WIDTH, Animation, coarse, page
from evaluation.figures.source import Source
from evaluation.generation import read_answers

COLUMNS = 3
# More make a picture that nobody looks at, and in the end one that no program opens.
MOST = 60
RIGHT, WRONG = "#1b7837", "#c1272d"


def generation(source: Source) -> Figure:
    """The actions of the most probable fit, the first `MOST` of them."""
    answered, logs, total, title = _carried_out(source, MOST)
    seen = [observation(log) for log in logs]
    pictures = [(one.image_before, one.image_after) for one in seen if one.image_after is not None]
    return generated_actions(answered, pictures, title + shown_of(len(answered), total))


def action(source: Source) -> Animation:
    """One action of the most probable fit, from outside."""
    answered, logs, *_ = _carried_out(source)
    frames = animation(logs[shown_action(answered, logs)], width=400, height=300, every=2)
    return Animation(frames, rate=8.0, hold=2.0)


def _carried_out(source: Source, most: int | None = None) -> tuple[pd.DataFrame, list[Log], int, str]:
    """The first answers of the most probable fit, the log of each, how many answers there are, and the title."""
    best, _, title = source.most_probable()
    every = read_answers(source.files["answers"][best])
    answered = every.head(len(every) if most is None else most)
    logs = [read_log(source.files["logs"][best] / f"trial_{trial:04}.mcap") for trial in answered["trial"]]
    return answered, logs, len(every), title


def shown_of(shown: int, total: int) -> str:
    """What a title adds where not all are shown."""
    return f"; the first {shown} of {total} instructions" if shown < total else ""


def generated_actions(answered: pd.DataFrame, pictures: Sequence[tuple[Image, Image]], title: str) -> Figure:
    """Draw each instruction with the scene before and after the action, and the tutor's word for what happened.

    Args:
        answered: The answers of one fit, as `evaluation.generation.read_answers` gives them.
        pictures: (H, W, 3) RGB before and after, of each answer.
        title: Experiment and condition.
    """
    rows = -(-len(pictures) // COLUMNS)
    heading = f"Instructions carried out: before, after, and what the tutor saw\n{title}"
    with page(0.6 + 1.2 * rows, heading) as figure:
        grid: Any = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for axes in grid:
            axes.set_axis_off()
        for axes, answer, (before, after) in zip(grid, answered.itertuples(), pictures, strict=False):
            axes.imshow(_side_by_side(before, after), interpolation="nearest")
            axes.set_title(f"{answer.trial}. “{answer.instruction}”", fontsize=8, loc="left", pad=3)
            text, shade = in_words(str(answer.action), str(answer.judged), float(str(answer.object_right)))
            axes.text(0.0, -0.03, text, transform=axes.transAxes, va="top", fontsize=7, color=shade)
    return figure


def in_words(asked: str, judged: str, object_right: float) -> tuple[str, str]:
    """What is written under an action, and in which color: whether word and object are right."""
    word = f"{judged}: right word" if judged == asked else f"{judged}: not {asked}"
    thing = {1.0: "right object", 0.0: "wrong object"}.get(object_right, "object chosen among equals")
    return f"{word}, {thing}", RIGHT if judged == asked and object_right == 1.0 else WRONG


def shown_action(answered: pd.DataFrame, logs: Sequence[Log]) -> int:
    """Which action is animated: the first with the right word and object in which the hand moved; else the first."""
    right = (answered["action"] == answered["judged"]) & (answered["object_right"] == 1.0)
    for i, log in enumerate(logs):
        happened = truth(log)
        if right.iloc[i] and happened is not None and happened.outcome["action"] != "look-at":
            return i
    return 0


def _side_by_side(before: Image, after: Image) -> Image:
    """Both pictures, as small as they will be printed."""
    width = int(DPI * PAGE_WIDTH / COLUMNS / 2 * 0.96)
    size = (width, round(width * before.shape[0] / before.shape[1]))
    small = [np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8) for image in (before, after)]
    gap = np.full((size[1], 4, 3), 255, dtype=np.uint8)
    return coarse(np.hstack([small[0], gap, small[1]]))
