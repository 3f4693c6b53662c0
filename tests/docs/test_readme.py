"""What the README says of the results is what the reference run found."""

from __future__ import annotations

import re

import pandas as pd

from tests.docs.pages import ROOT

TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
REFERENCE = ROOT / "results" / "reference"


def test_the_claims_are_counted() -> None:
    verdicts = pd.read_csv(REFERENCE / "claims.csv")["verdict"].value_counts()
    [found] = re.findall(
        r"Of the paper's (\d+) claims (\d+) hold here, (\d+) do not, and (\d+) are not decidable", TEXT
    )
    said = dict(zip(("holds", "does not hold", "not decidable"), map(int, found[1:]), strict=True))
    assert said == verdicts.to_dict()
    assert int(found[0]) == verdicts.sum()


def test_the_channels_found_are_those_of_table_1b() -> None:
    scores = pd.read_csv(REFERENCE / "scores.csv")
    of = scores[(scores.experiment == "simulator") & (scores.D == 40) & (scores.ROW == 0) & (scores.measure == "EAR")]
    means = of.groupby("method")["value"].mean()
    [found] = re.findall(r"right channel of (\d+) % of the words, against (\d+) % without", TEXT)
    assert [round(100 * means[method]) for method in ("proposed", "no_mec2")] == list(map(int, found))
