"""What the results of a study say of the paper's claims: `claims.csv` and the comparisons behind it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, astuple, replace
from itertools import combinations

import numpy as np
import pandas as pd

from data_collection.seeding import generator
from evaluation.catalogue import cell_name, paper_table_with
from evaluation.claims.judging import FAILS, HOLDS, NOT_RUN, OPEN, Cell, combine, judge
from evaluation.claims.paper import CLAIMS
from evaluation.claims.terms import ACTION_WORDS, IS, SHADES_APART, Claim, confused
from evaluation.differences import signed
from evaluation.measures import MEASURES
from evaluation.metrics import confusion
from evaluation.scores import COLUMNS, CONDITION, UNITS

# Whose fits the claims are about: those of the paper's algorithm with the config's own hyperparameters.
VARIANT, SAMPLER = "default", "published"
# Beyond so many data sets a number is no plan.
MOST_SETS = 1000
CELL = ["experiment", "D", "ROW", "method", "measure", "variant"]
CLAIM_COLUMNS = ["claim", "text", "experiment", "paper", "ours", "verdict", "datasets", "needed"]
CLAIM_COLUMNS += ["other_samplers", "rests_on", "note"]
COMPARISON_COLUMNS = [
    *("claim", "sampler", "comparison", "left", "right", "difference", "low", "high", "bound", "n", "datasets"),
    *("needed", "verdict", "rests_on"),
]


def description_scores(descriptions: pd.DataFrame) -> pd.DataFrame:
    """Measures of parts of the descriptions that `scores.csv` does not have, in the form of scores.

    `F1_{channel}`: the mean over the words of a channel that the tutor said of the word's F1 among all words, so that
    one said for a word of another channel counts against it. `confused a/b`: how often one of two action words was
    said for the other, for pairs of which the tutor said at least one.
    """
    rows = []
    for names, told in descriptions.groupby(CONDITION):
        true, said = told["true"].tolist(), told["described"].tolist()
        words = sorted({*true, *said, *ACTION_WORDS})
        counts, place = confusion(true, said, words), {word: i for i, word in enumerate(words)}
        f1 = 2 * np.diag(counts) / (counts.sum(axis=0) + counts.sum(axis=1)).clip(1)
        channel_of = dict(zip(true, told["channel"], strict=True))
        measures = {
            f"F1_{channel}": float(np.mean([f1[place[word]] for word, own in channel_of.items() if own == channel]))
            for channel in sorted(set(channel_of.values()))
        }
        for a, b in combinations(ACTION_WORDS, 2):
            if not channel_of.keys().isdisjoint((a, b)):
                measures[confused(a, b)] = float(counts[place[a], place[b]] + counts[place[b], place[a]])
        rows += [{**dict(zip(CONDITION, names, strict=True)), "measure": m, "value": v} for m, v in measures.items()]
    return pd.DataFrame(rows, columns=COLUMNS)


def judge_claims(
    scores: pd.DataFrame, descriptions: pd.DataFrame, shown: pd.DataFrame | None = None
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Decide every claim from a study's results, by the rules of `judging.judge` and `judging.combine`.

    Args:
        scores: All rows of `scores.csv`.
        descriptions: What `description.read_descriptions` gives for both experiments.
        shown: What was measured of the fits that figures show, in the form of scores; of any variant.

    Returns:
        The claims (`CLAIM_COLUMNS`) and their comparisons (`COMPARISON_COLUMNS`). `left` and `right` are the two
        sides, means over so many `datasets` and `n` fits, `low` to `high` the 95 % interval of the difference, and
        `needed` how many data sets would decide what is not decidable; `rests_on` are the cells as links from the
        output folder. What the study did not run is `not run`, and its numbers empty.
        The verdict is that by `SAMPLER`; `other_samplers` tells what each other sampler's fits would make it.
    """
    scores, descriptions = (rows[rows["variant"] == VARIANT] for rows in (scores, descriptions))
    used, told = scores, description_scores(descriptions)
    used = pd.concat([used, *(more for more in (told, shown) if more is not None and len(more))])
    used = used.dropna(subset=["value"])
    samplers = list(dict.fromkeys([SAMPLER, *scores["sampler"]]))
    cells: dict[tuple[object, ...], pd.Series[float]] = {
        tuple(names): group for names, group in used.set_index(UNITS).groupby(["sampler", *CELL])["value"]
    }
    claims, comparisons = [], []
    for claim in CLAIMS:
        rows = pd.DataFrame([row for sampler in samplers for row in _comparison_rows(claim, sampler, cells)])
        comparisons.append(rows)
        claims.append(_claim_row(claim, {sampler: rows[rows["sampler"] == sampler] for sampler in samplers}))
    return pd.DataFrame(claims, columns=CLAIM_COLUMNS), pd.concat(comparisons, ignore_index=True)[COMPARISON_COLUMNS]


def _comparison_rows(
    claim: Claim, sampler: str, cells: Mapping[tuple[object, ...], pd.Series[float]]
) -> Iterator[dict[str, object]]:
    """Decide the comparisons of a claim by the fits of a sampler; every sampler has the same bootstrap samples."""
    for comparison in claim.comparisons:
        rng = generator(0, "claims", claim.number, str(comparison))
        judgment = judge(comparison, lambda cell: values_of(cell, sampler, cells), rng)
        links = dict.fromkeys(link(cell, sampler) for cell in comparison.cells)
        names = {"claim": claim.number, "sampler": sampler, "comparison": str(comparison), "bound": comparison.bound}
        yield names | asdict(judgment) | {"rests_on": " ".join(links) if judgment.verdict != NOT_RUN else ""}


def values_of(cell: Cell, sampler: str, cells: Mapping[tuple[object, ...], pd.Series[float]]) -> pd.Series[float]:
    """The values of a cell by a sampler's fits, indexed by `UNITS`; of `terms.exactly` 1 and 0. Empty if not run."""
    measure, _, value = cell.measure.partition(IS)
    found = cells.get((sampler, *astuple(replace(cell, measure=measure))), pd.Series(dtype=float))
    return (found == float(value)).astype(float) if value else found


def link(cell: Cell, sampler: str) -> str:
    """Where a cell of a sampler's fits is shown, from the output folder: in a page of a table, or a file."""
    if cell.measure == SHADES_APART:
        return "claims_shades.csv"
    if cell.measure.startswith("used_"):
        return "scores.csv"
    task = {measure.name: measure.task for measure in MEASURES}.get(cell.measure, "")
    table = paper_table_with(cell.experiment, task, cell.D)
    if table is None:
        return f"descriptions/{cell.experiment}_D{cell.D}.csv"
    return f"tables/{table}.html#{cell_name({'sampler': sampler, **asdict(cell)}, cell.measure)}"


def _claim_row(claim: Claim, by_sampler: Mapping[str, pd.DataFrame]) -> dict[str, object]:
    verdicts = {sampler: combine(rows["verdict"].tolist()) for sampler, rows in by_sampler.items()}
    judged = by_sampler[SAMPLER]
    pages = dict.fromkeys(place.partition("#")[0] for links in judged["rests_on"] for place in links.split())
    return vars(claim) | {
        "claim": claim.number,
        "experiment": claim.experiment,
        "ours": _ours(judged[judged["verdict"] != NOT_RUN]),
        "verdict": verdicts.pop(SAMPLER),
        "datasets": int(judged["datasets"].min()),
        "needed": _needed(judged),
        "other_samplers": "; ".join(f"{sampler}: {verdict}" for sampler, verdict in verdicts.items()),
        "rests_on": " ".join(pages),
    }


def _needed(judged: pd.DataFrame) -> str:
    """About how many data sets would decide a claim that is not decidable: those of its worst comparison, in text.

    Empty for other claims, and of one data set, whose spread says nothing of others.
    """
    needed = judged.loc[judged["verdict"] == OPEN, "needed"].dropna()
    if combine(judged["verdict"].tolist()) != OPEN or needed.empty:
        return ""
    return f"{needed.max():.0f}" if needed.max() <= MOST_SETS else f"more than {MOST_SETS}"


def _ours(run: pd.DataFrame) -> str:
    """What was found, in a line: the differences, and for several comparisons how many of them hold."""
    if run.empty:
        return ""
    if len(run) == 1:
        one = run.iloc[0]
        interval = f"[{signed(one['low'])}, {signed(one['high'])}]"
        return f"{one['left']:.3f} and {one['right']:.3f}: difference {signed(one['difference'])} {interval}"
    counts = run["verdict"].value_counts()
    told = ", ".join(f"{verdict} {counts[verdict]}" for verdict in (HOLDS, FAILS, OPEN) if verdict in counts)
    least, most = signed(run["difference"].min()), signed(run["difference"].max())
    return f"{len(run)} comparisons: {told}; differences {least} to {most}"
