"""Every table of a study, from its scores and its answers to uncertain instructions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

import pandas as pd

from data_collection.files import replacing
from evaluation.catalogue import Table
from evaluation.scores import read_scores
from evaluation.table_forms import Sheet, files
from evaluation.tables import sheet_of_scores
from evaluation.uncertain.answers import read_uncertain
from evaluation.uncertain.table import sheet_of_answers


def sheets(tables: Mapping[str, Table], scores: Path, uncertain: Iterable[Path]) -> dict[str, Sheet]:
    """What the tables hold, by name.

    Args:
        tables: Which part of the results each shows.
        scores: `scores.csv`.
        uncertain: The files of answers to uncertain instructions.
    """
    measured, paths = read_scores([scores]), list(uncertain)
    answered = read_uncertain(paths) if paths else pd.DataFrame()
    return {
        name: sheet_of_answers(answered, table) if table.tasks == ("uncertain",) else sheet_of_scores(measured, table)
        for name, table in tables.items()
    }


def write(name: str, sheet: Sheet, folder: Path) -> None:
    """Write all files of a table; they begin with its name."""
    for ending, text in files(sheet).items():
        with replacing(folder / f"{name}{ending}") as (temporary,):
            temporary.write_text(text, encoding="utf-8")
