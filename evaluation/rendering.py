"""Every table of a study, from its scores and its answers to uncertain instructions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pandas as pd

from data_collection.files import write_text
from evaluation.catalogue import Table
from evaluation.convergence import distrust, read_lights
from evaluation.scores import read_scores
from evaluation.table_forms import Sheet, files
from evaluation.tables import select, sheet_of_scores
from evaluation.uncertain.answers import read_uncertain
from evaluation.uncertain.table import sheet_of_answers

# How a table is made, by what it is made of.
SHEETS = {"scores": sheet_of_scores, "answers": sheet_of_answers}


def sheets(
    tables: Mapping[str, Table], scores: Path, uncertain: Sequence[Path], convergence: Path
) -> dict[str, Sheet]:
    """What the tables hold, by name.

    Args:
        tables: Which part of the results each shows.
        scores: `scores.csv`.
        uncertain: The files of answers to uncertain instructions.
        convergence: `convergence.csv`; each note says which of the fits have not converged.
    """
    rows = {"scores": read_scores([scores]), "answers": read_uncertain(uncertain) if uncertain else pd.DataFrame()}
    found, made = read_lights(convergence), {}
    for name, table in tables.items():
        sheet, shown = SHEETS[table.rows](rows[table.rows], table), select(rows[table.rows], table)
        made[name] = replace(sheet, note=f"{sheet.note} {distrust(shown, found)}".strip())
    return made


def write(name: str, sheet: Sheet, folder: Path) -> None:
    """Write all files of a table; they begin with its name."""
    for ending, text in files(sheet).items():
        write_text(folder / f"{name}{ending}", text)
