"""What people say that the robot did: the form that they fill in, and the human WAR that comes of it."""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from data_collection.files import write_text
from evaluation.scores import SEEDS, in_order, write_csv
from evaluation.templates import render

RATED = ("clip", "rater", "word")
FORM_COLUMNS = (*RATED, "allowed")
KEY_COLUMNS = ("clip", *SEEDS, "seed", "trial", "instructed", "judged", "allowed")


class RatingError(ValueError):
    """Forms that cannot be counted; `problems` lists everything that is wrong with them."""

    def __init__(self, problems: Sequence[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(problems))


@dataclass(frozen=True)
class Rating:
    """One rater's word for what happens in one clip."""

    clip: str
    rater: str
    word: str


def make_key(rows: Sequence[Mapping[str, object]], allowed: Sequence[str], rng: np.random.Generator) -> pd.DataFrame:
    """Name the actions to rate clip_3fa94c_001, … in an order that tells nothing about their conditions.

    The names hold a digest of the key, so that a form for an earlier key is not counted against this one.

    Args:
        rows: One per action, with the columns of `KEY_COLUMNS` except `clip` and `allowed`.
        allowed: The words that raters choose from.
        rng: Draws the order.

    Returns:
        Columns `KEY_COLUMNS` and any others of `rows`, a row per clip, in the order of the clips.
    """
    order = [rows[i] for i in rng.permutation(len(rows))]
    told = json.dumps([order, list(allowed)], sort_keys=True, default=str, ensure_ascii=True)
    digest = hashlib.sha256(told.encode()).hexdigest()[:6]
    key = pd.DataFrame(
        [{"clip": f"clip_{digest}_{i + 1:03}", **row, "allowed": " ".join(allowed)} for i, row in enumerate(order)]
    )
    return key[[*KEY_COLUMNS, *(name for name in key.columns if name not in KEY_COLUMNS)]]


def write_form(key: pd.DataFrame, path: Path) -> None:
    """Write the form to fill in: a row per clip, rater and word empty."""
    write_csv(key[["clip", "allowed"]].assign(rater="", word="")[list(FORM_COLUMNS)], path)


def write_page(clips: Sequence[tuple[str, str, Sequence[str]]], title: str, path: Path) -> None:
    """Write the page on which people rate clips; it needs no server, and saves the filled-in form as CSV.

    Args:
        clips: Name, path of the picture relative to the page, and allowed words of each clip.
        title: Heading of the page.
        path: The page.
    """
    write_text(path, render("ratings.html", clips=clips, title=title))


def read_key(path: Path) -> pd.DataFrame:
    """Read a key.

    Raises:
        RatingError: The file is missing or no key.
    """
    try:
        key = pd.read_csv(path, dtype={"clip": str, "instructed": str, "judged": str, "allowed": str})
    except (OSError, ValueError) as error:
        raise RatingError([f"{path}: cannot be read as a key ({error})"]) from error
    missing = [column for column in KEY_COLUMNS if column not in key.columns]
    if missing:
        raise RatingError([f"{path}: no key, the columns {', '.join(missing)} are missing"])
    return key


def read_forms(paths: Sequence[Path], key: pd.DataFrame) -> list[Rating]:
    """Read filled-in forms of one or more raters; clips without a word were not rated.

    Args:
        paths: CSV files with the columns clip, rater and word, parted by commas or semicolons.
        key: The key of the clips.

    Raises:
        RatingError: A clip is unknown, a word not allowed, a rater without name, or a clip rated twice by one
            rater; the message lists all of these with file and line.
    """
    allowed = dict(zip(key["clip"], key["allowed"].str.split(), strict=True))
    problems: list[str] = []
    ratings: dict[tuple[str, str], tuple[str, Rating]] = {}
    for path in paths:
        for where, row in _rows(path, problems):
            rating = Rating(**row)
            earlier = ratings.get((rating.rater, rating.clip))
            if rating.clip not in allowed:
                problems.append(f"{where}: clip {rating.clip!r} is unknown (allowed: {_span(list(allowed))})")
            elif not rating.word:
                continue
            elif rating.word not in allowed[rating.clip]:
                words = ", ".join(allowed[rating.clip])
                problems.append(f"{where}: {rating.word!r} is not a word to choose (allowed: {words})")
            elif not rating.rater:
                problems.append(f"{where}: the rater is missing (any name, the same in all of a rater's rows)")
            elif earlier is not None:
                problems.append(f"{where}: {rating.rater} has rated {rating.clip} before, in {earlier[0]}")
            else:
                ratings[rating.rater, rating.clip] = (where, rating)
    if not problems and not ratings:
        problems.append(f"{', '.join(map(str, paths))}: no clip is rated")
    if problems:
        raise RatingError(problems)
    return [rating for _, rating in ratings.values()]


def _rows(path: Path, problems: list[str]) -> Iterator[tuple[str, dict[str, str]]]:
    """Each row of a form with where it stands."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        problems.append(f"{path}: cannot be read ({error})")
        return
    # Spreadsheets write semicolons where the comma is the decimal sign.
    delimiter = ";" if lines and ";" in lines[0] else ","
    reader = csv.DictReader(lines, delimiter=delimiter)
    missing = [column for column in RATED if column not in (reader.fieldnames or ())]
    if missing:
        expected = ", ".join(RATED)
        problems.append(f"{path}: no form, the columns {', '.join(missing)} are missing (expected: {expected})")
        return
    for row in reader:
        yield f"{path}, line {reader.line_num}", {name: (row[name] or "").strip() for name in RATED}


def _span(names: Sequence[str]) -> str:
    return f"{names[0]} to {names[-1]}" if names else "there is none"


def human_rates(ratings: Sequence[Rating], key: pd.DataFrame) -> pd.DataFrame:
    """The human WAR of each condition, beside the automatic one.

    Returns:
        One row per condition that was rated, seeds together: Its names, `raters`, `ratings`, `human_WAR` (the share
        of a rater's clips whose word is the instructed one, mean over raters), `human_WAR_sd` (standard deviation
        over raters, n − 1), `automatic_WAR` (over the clips that somebody rated) and `agreement` (the share of
        ratings that equal the automatic judgement).
    """
    told = pd.DataFrame([vars(rating) for rating in ratings]).merge(key, on="clip")
    told["right"] = told["word"] == told["instructed"]
    told["agrees"] = told["word"] == told["judged"]
    rows = []
    for condition, own in told.groupby(SEEDS, sort=False):
        by_rater = own.groupby("rater")["right"].mean()
        clips = own.drop_duplicates("clip")
        rows.append(
            {
                **dict(zip(SEEDS, condition, strict=True)),
                "raters": len(by_rater),
                "ratings": len(own),
                "human_WAR": by_rater.mean(),
                "human_WAR_sd": by_rater.std(ddof=1),
                "automatic_WAR": (clips["judged"] == clips["instructed"]).mean(),
                "agreement": own["agrees"].mean(),
            }
        )
    return in_order(pd.DataFrame(rows), SEEDS)
