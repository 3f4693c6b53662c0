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
    means = of[of.variant == "default"].groupby(["sampler", "method"])["value"].mean()
    told = r"of (\d+) % of the words by the paper's sampler, against (\d+) % without .* of (\d+) %\nagainst (\d+) %"
    [found] = re.findall(told, TEXT, flags=re.DOTALL)
    cells = [(sampler, method) for sampler in ("published", "mixing") for method in ("proposed", "no_mec2")]
    assert [round(100 * means[cell]) for cell in cells] == list(map(int, found))
