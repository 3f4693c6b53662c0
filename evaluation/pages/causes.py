"""The section of the report that tells what differs because of the model from what differs because of the sampler."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from evaluation.claims.judging import OPEN
from evaluation.differences import letter, signed
from evaluation.effects import EQUAL, GIVEN, HIGHER, LOWER, effects
from evaluation.measures import COMPARED
from evaluation.pages.page import Section
from evaluation.scores import varying
from evaluation.table_forms import Grid, by_measure, fragment
from evaluation.templates import render, wide
from model import METHODS


def section(scores: pd.DataFrame) -> Section:
    """Differences between samplers and between methods, and which of the latter hang on the sampler.

    Args:
        scores: All rows of `scores.csv`.
    """
    found = effects(scores)
    tables = {"by_sampler": _table(found, "sampler"), "by_model": _table(found, "method")}
    said = list(sentences(found[found.compared == "method"]))
    samplers = list(scores["sampler"].unique())
    counts = {name: own["dataset"].nunique() for name, own in scores.groupby("experiment", sort=False)}
    shown = {"over": ", ".join(f"{name!s}: {n}" for name, n in counts.items()), "one": min(counts.values()) == 1}
    text = render("causes.html", samplers=samplers, said=said, **shown, **tables)
    return Section("causes", "Model and sampler", text, folded=True)


def _table(found: pd.DataFrame, axis: str) -> str:
    """The differences of one axis in HTML: a row for each pair and what is given, a column for each measure."""
    own = found[found.compared == axis]
    if own.empty:
        return "<p>Nothing was run that could be compared.</p>"
    keys = ["experiment", "side", "other", "given"]
    measures = [measure for measure in COMPARED if measure in set(own.measure)]
    numbers = zip(own["mean"], own.low, own.high, strict=True)
    texts = [f"{signed(mean)} ({signed(low)}\u00a0to\u00a0{signed(high)})" for mean, low, high in numbers]
    rows = by_measure(own, keys, texts, measures)
    bold = by_measure(own, keys, own.found.isin([HIGHER, LOWER]), measures)[measures].eq(True)
    given = GIVEN[axis]
    rows["difference"] = [pair(axis, *names) for names in zip(rows.side, rows.other, strict=True)]
    rows[given] = [METHODS[name].label for name in rows.given] if given == "method" else rows.given
    shown = rows[[*varying(rows, ["experiment"]), "difference", given, *measures]]
    return wide(fragment(Grid("", shown, bold), captioned=False))


def pair(axis: str, side: str, other: str) -> str:
    """What is compared, as people read it."""
    names = (letter(side), letter(other)) if axis == "method" else (side, other)
    return " − ".join(names)


def sentences(found: pd.DataFrame) -> Iterator[str]:
    """What the samplers say together of each difference between methods, a line for each experiment and pair.

    A measure is higher or lower whatever the sampler if each sampler finds it so, and not decided if each leaves it
    open or finds no difference. All others depend on the sampler, and what each finds is told.

    Args:
        found: Rows of `effects` that compare methods. Measures that one sampler alone has are left out.
    """
    for names, own in found.groupby(["experiment", "side", "other"], sort=False):
        experiment, side, other = map(str, names)
        groups: dict[str, list[str]] = {HIGHER: [], LOWER: [], OPEN: [], "": []}
        for measure in COMPARED:
            by_sampler = own[own.measure == measure].set_index("given")["found"].replace(EQUAL, OPEN)
            if len(by_sampler) > 1:
                same = by_sampler.nunique() == 1
                found_by = by_sampler.groupby(by_sampler, sort=False)
                each = "; ".join(f"{finding} with {', '.join(who.index)}" for finding, who in found_by)
                groups[by_sampler.iloc[0] if same else ""].append(measure if same else f"{measure} ({each})")
        told = {
            "higher whatever the sampler": groups[HIGHER],
            "lower whatever the sampler": groups[LOWER],
            "not decided by any": groups[OPEN],
            "depending on the sampler": groups[""],
        }
        if any(told.values()):
            parts = "; ".join(f"{what}: {', '.join(measures)}" for what, measures in told.items() if measures)
            yield f"{pair('method', side, other)}, {experiment}: {parts}."
