"""Where the results of a study may go."""

from __future__ import annotations

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = (
    *("data_collection", "features", "model", "evaluation", "workflow", "tests", "benchmarks", "docs", "config"),
    *(".git", ".ci", "results/reference"),
)


def refuse_sources(out: Path) -> None:
    """Refuse an output folder that holds the program itself, or is a part of it.

    Raises:
        ValueError: Results there would stand among the sources, or replace them.
    """
    place = out.resolve()
    named = Path(os.path.normpath(out.absolute()))  # .venv may be a link
    inside = next((ROOT / name for name in SOURCES if place.is_relative_to(ROOT / name)), None)
    if any(one.parent == ROOT and one.name.startswith(".venv") for one in (named, *named.parents)):
        inside = ROOT / ".venv"
    if inside or ROOT.is_relative_to(place):
        what = f"a part of {inside}" if inside else f"the folder of the program, {ROOT}, or holds it"
        raise ValueError(f"--out {out}: is {what}; results would stand among the sources (name another folder)")
