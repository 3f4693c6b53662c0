"""The one order of the trials of a set: that of the numbers in the names of their files, trial_0001.mcap and so on.

A log may say another number for itself (robots go on counting from day to day), under which its trial stands in
tables; then the numbers rise with those of the files. So it makes no difference which trials one job looks at.
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from data_collection.limits import MAX_TRIAL

_FILE = re.compile(r"trial_([0-9]{4,7})\.mcap")


def file_of_trial(number: int) -> str:
    """Return what the file of a trial is called."""
    return f"trial_{number:04}.mcap"


def number_of(source: str, metadata: Mapping[str, str]) -> int | None:
    """Return the number of a trial: what the log says, or else its file's name; None where neither is one.

    Args:
        source: Path of the file.
        metadata: Of the log; `trial` may be missing, since recorders do not know of it.
    """
    said = metadata.get("trial", str(_file_number(source) or ""))
    return int(said) if re.fullmatch("[0-9]{1,7}", said) and 1 <= int(said) <= MAX_TRIAL else None


def order_problems(numbered: Iterable[tuple[str, int]]) -> Iterator[str]:
    """Yield where the numbers that logs say are the same, or contradict the order of their files.

    Args:
        numbered: Path and number of each log of a set, in any order.
    """
    first: dict[int, str] = {}
    highest: tuple[str, int] | None = None
    for source, number in sorted(numbered, key=lambda one: _file_number(one[0]) or 0):
        if number in first:
            yield f"{source}: says that it is trial {number}, and so does {first[number]}"
        elif highest is not None and number < highest[1] and _file_number(source) is not None:
            yield (
                f"{source}: says that it is trial {number}, and {highest[0]} before it that it is {highest[1]}; "
                "the numbers must rise in the order of the files, by which D counts"
            )
        first.setdefault(number, source)
        if highest is None or number > highest[1]:
            highest = source, number


def _file_number(source: str) -> int | None:
    """Return the number in the name of a file; None where it has none."""
    named = _FILE.fullmatch(Path(source).name)
    return int(named[1]) if named else None
