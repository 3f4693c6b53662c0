"""The tables of a study, as data. Imports nothing heavy, because the rules read it too."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

TABLE_FORMS = ("csv", "md", "tex", "html")


@dataclass(frozen=True)
class TaskTables:
    """What the tables of a task have in common.

    Attributes:
        title: What they are about.
        rows: What they are made of: a key of `evaluation.rendering.SHEETS`.
        more: The endings of further files.
    """

    title: str
    rows: str = "scores"
    more: tuple[str, ...] = ("_differences.csv",)


TASKS = {
    "csl": TaskTables("Learning"),
    "generation": TaskTables("Action generation"),
    "description": TaskTables("Action description"),
    "uncertain": TaskTables("Uncertain instructions", rows="answers", more=()),
}


@dataclass(frozen=True)
class Table:
    """One table: the part of the scores, or of the answers to uncertain instructions, that it shows.

    Attributes:
        title: Its heading.
        experiment: The experiment that it shows.
        tasks: Those whose measures are its columns, of those that are run; several have the same `rows`.
        D: The one number of trials that it shows, None for all.
        without: The variants that it leaves out.
    """

    title: str
    experiment: str
    tasks: tuple[str, ...]
    D: int | None = None
    without: tuple[str, ...] = ()

    @property
    def rows(self) -> str:
        """What it is made of."""
        return TASKS[self.tasks[0]].rows

    @property
    def endings(self) -> tuple[str, ...]:
        """How the names of its files end."""
        return (*(f".{form}" for form in TABLE_FORMS), *TASKS[self.tasks[0]].more)


# The tables of the paper: file name, number, experiment, tasks, D.
PAPER_TABLES = (
    ("table_1a", "1A", "simulator", ("csl",), 20),
    ("table_1b", "1B", "simulator", ("csl",), 40),
    ("table_2", "2", "simulator", ("generation",), None),
    ("table_3", "3", "simulator", ("description",), None),
    ("table_4", "4", "real", ("csl",), None),
    ("table_5", "5", "real", ("description", "generation"), None),
)


def tables_of(
    conditions: Iterable[tuple[str, str, int]], partial: Mapping[str, Sequence[str]] | None = None
) -> dict[str, Table]:
    """The tables of a study by file name: those of the paper that it can fill, and one for each experiment and task.

    Args:
        conditions: Each (experiment, task, D) that is run.
        partial: By experiment, the variants that are run for a part of the conditions only, as for one figure; the
            paper's tables leave them out, and those of the experiment show them.
    """
    run = set(conditions)
    tables = {}
    for name, number, experiment, all_tasks, D in PAPER_TABLES:
        tasks = tuple(task for task in all_tasks if any((experiment, task, D or d) in run for _, _, d in run))
        if tasks:
            which = _which_D(D or d for e, task, d in run if e == experiment and task in tasks)
            title = " and ".join(TASKS[task].title.lower() for task in tasks).capitalize()
            without = tuple((partial or {}).get(experiment, ()))
            tables[name] = Table(f"Table {number}. {title}, {experiment}{which}", experiment, tasks, D, without)
    for experiment, task in sorted({(experiment, task) for experiment, task, _ in run}):
        which = _which_D(D for e, t, D in run if (e, t) == (experiment, task))
        tables[f"{experiment}_{task}"] = Table(f"{TASKS[task].title}, {experiment}{which}", experiment, (task,))
    return tables


def _which_D(Ds: Iterable[int]) -> str:  # noqa: N802 (D is the paper's)
    """How a title names the D of a table that shows one only; a column tells several."""
    found = set(Ds)
    return f", D = {found.pop()}" if len(found) == 1 else ""


def files_of_tables(tables: Mapping[str, Table]) -> list[str]:
    """The names of all files of these tables."""
    return [f"{name}{ending}" for name, table in tables.items() for ending in table.endings]


def paper_table_with(experiment: str, task: str, D: int) -> str | None:
    """The name of the paper's table that shows a task of an experiment at a D; None where none does."""
    for name, _, of_experiment, tasks, of_D in PAPER_TABLES:
        if of_experiment == experiment and of_D in (None, D) and task in tasks:
            return name
    return None


def cell_name(condition: Mapping[Any, object], measure: str) -> str:
    """The id of a cell in the page of a table, to which other pages link."""
    return "{variant}-{sampler}-D{D}-ROW{ROW}-{method}-".format_map(condition) + measure
