"""What the results of a study say of the paper's claims: `claims.csv` and the comparisons behind it."""

from __future__ import annotations

from dataclasses import asdict, astuple
from itertools import combinations

import numpy as np
import pandas as pd

from data_collection.seeding import generator
from evaluation.catalogue import cell_name, paper_table_with
from evaluation.claims.judging import FAILS, HOLDS, NOT_RUN, OPEN, Cell, Comparison, combine, judge
from evaluation.claims.paper import ACTION_WORDS, CLAIMS, Claim, confused
from evaluation.differences import signed
from evaluation.measures import MEASURES
from evaluation.metrics import confusion
from evaluation.scores import COLUMNS, CONDITION

# Whose fits the claims are about: those of the paper's algorithm with the config's own hyperparameters.
VARIANT, SAMPLER = "default", "published"
CELL = ["experiment", "D", "ROW", "method", "measure"]
CLAIM_COLUMNS = ["claim", "text", "experiment", "paper", "ours", "verdict", "rests_on", "note"]
COMPARISON_COLUMNS = [
    *("claim", "comparison", "left", "right", "difference", "low", "high", "bound", "n", "verdict", "rests_on")
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


def judge_claims(scores: pd.DataFrame, descriptions: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Decide every claim from a study's results, by the rules of `judging.judge` and `judging.combine`.

    Args:
        scores: All rows of `scores.csv`.
        descriptions: What `description.read_descriptions` gives for the simulator.

    Returns:
        The claims (`CLAIM_COLUMNS`) and their comparisons (`COMPARISON_COLUMNS`). `left` and `right` are the two
        sides, means over `n` seeds, `low` to `high` the 95 % interval of the difference; `rests_on` are the cells
        as links from the output folder. What the study did not run is `not run`, and its numbers empty.
    """
    used, told = _paper(scores), description_scores(_paper(descriptions))
    used = (pd.concat([used, told]) if len(told) else used).dropna(subset=["value"])
    by_cell: dict[tuple[object, ...], pd.Series[float]] = {
        tuple(names): group for names, group in used.set_index("seed").groupby(CELL)["value"]
    }
    empty = pd.Series(dtype=float)
    claims, comparisons = [], []
    for claim in CLAIMS:
        rows = []
        for comparison in claim.comparisons:
            rng = generator(0, "claims", claim.number, str(comparison))
            judgment = judge(comparison, lambda cell: by_cell.get(astuple(cell), empty), rng)
            rows.append(
                {"claim": claim.number, "comparison": str(comparison), "bound": comparison.bound}
                | {"rests_on": " ".join(_links(comparison) if judgment.verdict != NOT_RUN else [])}
                | asdict(judgment)
            )
        comparisons += rows
        claims.append(_claim_row(claim, pd.DataFrame(rows)))
    return pd.DataFrame(claims, columns=CLAIM_COLUMNS), pd.DataFrame(comparisons, columns=COMPARISON_COLUMNS)


def _paper(rows: pd.DataFrame) -> pd.DataFrame:
    return rows[(rows["variant"] == VARIANT) & (rows["sampler"] == SAMPLER)]


def link(cell: Cell) -> str:
    """Where a cell is shown, from the output folder: a place in the page of one of the paper's tables, or a file."""
    task = {measure.name: measure.task for measure in MEASURES}.get(cell.measure, "")
    table = paper_table_with(cell.experiment, task, cell.D)
    if table is None:
        return f"descriptions/{cell.experiment}_D{cell.D}.csv"
    return f"tables/{table}.html#{cell_name({'variant': VARIANT, 'sampler': SAMPLER, **asdict(cell)}, cell.measure)}"


def _links(comparison: Comparison) -> list[str]:
    return list(dict.fromkeys(link(cell) for cell in comparison.cells))


def _claim_row(claim: Claim, judged: pd.DataFrame) -> dict[str, object]:
    pages = dict.fromkeys(place.partition("#")[0] for links in judged["rests_on"] for place in links.split())
    return {
        "claim": claim.number,
        "text": claim.text,
        "experiment": claim.experiment,
        "paper": claim.paper,
        "ours": _ours(judged[judged["verdict"] != NOT_RUN]),
        "verdict": combine(judged["verdict"].tolist()),
        "rests_on": " ".join(pages),
        "note": claim.note,
    }


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
