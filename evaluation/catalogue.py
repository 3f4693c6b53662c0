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


CSL_MEASURES = ("ARI_a", "ARI_p", "ARI_o", "ARI_c", "EAR")

PAPER_TABLES = {
    "table_1a": Table("Table 1A. Learning, simulator, D = 20", "simulator", "csl", CSL_MEASURES, 20),
    "table_1b": Table("Table 1B. Learning, simulator, D = 40", "simulator", "csl", CSL_MEASURES, 40),
}


def tables_of(conditions: Iterable[tuple[str, int]]) -> dict[str, Table]:
    """The tables of a study by file name: those of the paper that it can fill, and one for each experiment.

    Args:
        conditions: each (experiment, D) that is run.
    """
    run = set(conditions)
    tables = {name: table for name, table in PAPER_TABLES.items() if (table.experiment, table.D) in run}
    for experiment in sorted({experiment for experiment, _ in run}):
        tables[f"{experiment}_csl"] = Table(f"Learning, {experiment}", experiment, "csl", CSL_MEASURES)
    return tables
