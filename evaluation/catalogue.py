"""What a study renders, as data: its tables and figures. Imports nothing heavy, because the rules read it too."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

TABLE_FORMS = ("csv", "md", "tex", "html")
FIT_FIGURES = ("words", "positions")


@dataclass(frozen=True)
class Table:
    """One table: the part of the scores that it shows.

    Attributes:
        title: its heading.
        experiment: the experiment whose scores it shows.
        task: `csl`, and later the tasks that use what was learned.
        measures: its columns.
        D: the one number of trials that it shows, None for all.
    """

    title: str
    experiment: str
    task: str
    measures: tuple[str, ...]
    D: int | None = None


MEASURES = {
    "csl": ("ARI_a", "ARI_p", "ARI_o", "ARI_c", "EAR"),
    "generation": ("WAR", "OAR"),
    "description": ("F1", "ACC"),
}
TITLES = {"csl": "Learning", "generation": "Action generation", "description": "Action description"}

# The tables of the paper: file name, number, experiment, task, D.
PAPER_TABLES = (
    ("table_1a", "1A", "simulator", "csl", 20),
    ("table_1b", "1B", "simulator", "csl", 40),
    ("table_2", "2", "simulator", "generation", None),
    ("table_3", "3", "simulator", "description", None),
    ("table_4", "4", "real", "csl", None),
    ("table_5", "5", "real", "description", None),
)


def tables_of(conditions: Iterable[tuple[str, str, int]]) -> dict[str, Table]:
    """The tables of a study by file name: those of the paper that it can fill, and one for each experiment and task.

    Args:
        conditions: each (experiment, task, D) that is run.
    """
    run = set(conditions)
    tables = {}
    for name, number, experiment, task, D in PAPER_TABLES:
        if (experiment, task, D) in run or (D is None and (experiment, task) in {condition[:2] for condition in run}):
            which = f", D = {D}" if D else ""
            title = f"Table {number}. {TITLES[task]}, {experiment}{which}"
            tables[name] = Table(title, experiment, task, MEASURES[task], D)
    for experiment, task in sorted({(experiment, task) for experiment, task, _ in run}):
        tables[f"{experiment}_{task}"] = Table(f"{TITLES[task]}, {experiment}", experiment, task, MEASURES[task])
    return tables
