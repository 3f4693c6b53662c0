"""The learned robots of a finished study: which there are, which is meant, and what one of them knows."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evaluation.data_sets import FitName, data_set_name
from evaluation.scores import read_scores
from features.transforms import Transforms, load_transforms
from model import METHODS, Fit, load

NAMES = ("experiment", "variant", "method", "sampler", "D", "ROW", "seed")
MANIFEST = "manifest.json"


class TalkError(ValueError):
    """What was asked for cannot be had; the message says what, and what can."""


class RobotName(FitName):
    """The names of a robot's fit."""

    @property
    def label(self) -> str:
        """What people read."""
        more = "" if self.variant == "default" else f", {self.variant}"
        said = f"{self.experiment}, D {self.D}, ROW {self.ROW} %, {self.sampler}"
        return f"{METHODS[self.method].label}{more}, seed {self.seed}, {said}"


@dataclass(frozen=True, eq=False)
class Robot:
    """What a robot has learned, and how it sees.

    Attributes:
        name: Which fit of the study it is.
        fit: What it learned.
        data: The data set that it learned from; another one's where experiments share data.
        transforms: From what it sees and feels to features; None where the features are somebody's own.
    """

    name: RobotName
    fit: Fit
    data: str
    transforms: Transforms | None


def robots_of(results: Path) -> list[RobotName]:
    """All robots of a study that hear words, in the order of its scores.

    Raises:
        TalkError: The folder holds no finished study, or one in which no robot hears words.
    """
    for file in (MANIFEST, "scores.csv"):
        if not (results / file).is_file():
            raise TalkError(f"{results / file} is missing: {results} is no folder of a finished study")
    names = read_scores([results / "scores.csv"])[["dataset", *NAMES]].drop_duplicates()
    found = [_named(row) for row in names.to_dict("records")]
    hearing = [name for name in found if METHODS[name.method].hears_words and name.ROW < 100]
    there = [name for name in hearing if (results / name.path).is_file()]
    if not there:
        raise TalkError(f"{results}: no fit of a method that hears words")
    return there


def _named(row: Mapping[Any, Any]) -> RobotName:
    names = {key: row[key] for key in NAMES}
    return RobotName(**names | {"experiment": data_set_name(row["experiment"], row["dataset"])})


def choose(results: Path, robots: Sequence[RobotName], asked: Mapping[str, str | int | None]) -> RobotName:
    """The robot that is meant: of those with the names that are asked for, the most probable fit.

    What is left open is the first experiment, the proposed method, the first variant, most trials and fewest words
    omitted; among samplers and seeds the fit with the highest log joint is taken.

    Args:
        results: The folder of results.
        robots: Those to choose from.
        asked: Names by key of `NAMES`; None leaves one open.

    Raises:
        TalkError: There is none; the message lists what is allowed.
    """
    left = list(robots)
    for key, value in asked.items():
        if value is not None:
            allowed = list(dict.fromkeys(getattr(name, key) for name in left))
            left = [name for name in left if getattr(name, key) == value]
            if not left:
                raise TalkError(f"{key}: no fit with {value!r} (allowed: {', '.join(map(str, allowed))})")
    methods, experiment = list(METHODS), left[0].experiment
    left = [name for name in left if name.experiment == experiment]
    method = min((name.method for name in left), key=methods.index)
    left = [name for name in left if name.method == method]
    variant = left[0].variant
    left = [name for name in left if name.variant == variant]
    D, ROW = max((name.D, -name.ROW) for name in left)
    left = [name for name in left if (name.D, -name.ROW) == (D, ROW)]
    return max(left, key=lambda name: _log_joint(results / name.path))


def _log_joint(path: Path) -> float:
    """The last log joint of a fit, of which nothing else is read."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            return float(stored["trace_log_joint"][-1])
    except (ValueError, KeyError, IndexError, EOFError) as error:
        raise TalkError(f"{path} is not a readable fit: {error}") from error


def load_robot(results: Path, name: RobotName) -> Robot:
    """Load what a robot knows.

    Raises:
        TalkError: A file is missing.
        ValueError: One is damaged; the message names it.
    """
    if not (results / name.path).is_file():
        raise TalkError(f"{results / name.path}: there is no such fit")
    data = _data_of(results, name)
    transforms = results / "features" / data / f"D{name.D}" / "transforms.npz"
    fitted = load_transforms(transforms) if transforms.is_file() else None
    return Robot(name, load(results / name.path), data, fitted)


def _data_of(results: Path, name: RobotName) -> str:
    """The data set that a fit was made from, by the manifest: experiments may share their data."""
    try:
        artifacts = json.loads((results / MANIFEST).read_text(encoding="utf-8"))["artifacts"]
        return str(Path(artifacts[name.path]["inputs"]["trials"]["path"]).parts[1])
    except (OSError, ValueError, KeyError, TypeError, IndexError) as error:
        raise TalkError(f"{results / MANIFEST} does not tell what {name.path} was made from ({error!r})") from error
