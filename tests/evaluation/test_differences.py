"""Paired differences: the test against scipy, the pairs against plain arithmetic."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy.stats import PermutationMethod, wilcoxon

from evaluation.differences import differences, readable_differences, signed_rank_p
from tests.evaluation.hand_made import scores_of


@pytest.mark.parametrize("n", [2, 5, 10, 20])
def test_signed_ranks_are_those_of_scipy(n: int) -> None:
    rng = np.random.default_rng(n)
    for shift in (0.0, 0.3, 1.0):
        values = rng.normal(shift, 1.0, n)
        assert signed_rank_p(values) == pytest.approx(wilcoxon(values, method="exact").pvalue, rel=1e-10)


def test_ties_are_exact_too() -> None:
    """Against all 2^n signs; scipy's own exact distribution knows no ties."""
    rng = np.random.default_rng(3)
    for _ in range(5):
        values = rng.integers(-3, 5, 10) / 12
        values = values[values != 0]
        every_sign = wilcoxon(values, method=PermutationMethod(n_resamples=2**10)).pvalue
        assert signed_rank_p(values) == pytest.approx(every_sign, rel=1e-10)


def test_rounding_does_not_break_ties() -> None:
    assert signed_rank_p(np.array([0.1 + 0.2, 0.3, 0.0])) == signed_rank_p(np.array([1.0, 1.0])) == 0.5


def test_no_difference_and_no_values() -> None:
    assert signed_rank_p(np.zeros(10)) == 1.0
    assert np.isnan(signed_rank_p(np.array([])))


def test_seeds_are_paired() -> None:
    """Seed 3 is undefined for B, so it is left out of the pair; the shift between the methods is always 0.1."""
    found = differences(
        scores_of(
            {
                ("csl", "proposed", 20, 0, "EAR"): [0.3, 0.9, 0.5],
                ("csl", "no_mec2", 20, 0, "EAR"): [0.2, 0.8, np.nan],
                ("csl", "mmlda", 20, 0, "EAR"): [np.nan, np.nan, np.nan],
                ("csl", "mmlda", 20, 0, "ARI_a"): [0.0, 0.0, 0.0],
                ("csl", "proposed", 20, 0, "ARI_a"): [0.2, 0.1, 0.3],
            }
        ),
        ("ARI_a", "EAR"),
    )
    assert found[["method", "other", "measure", "n"]].to_numpy().tolist() == [
        ["proposed", "no_mec2", "EAR", 2],
        ["proposed", "mmlda", "ARI_a", 3],
    ]
    assert found["mean"].tolist() == pytest.approx([0.1, 0.2])
    assert found["sd"].tolist() == pytest.approx([0.0, 0.1])
    assert found["p"].tolist() == pytest.approx([0.5, 0.25])
    shown = readable_differences(found, ("ARI_a", "EAR"))
    assert shown.to_numpy().tolist() == [
        [0, "A − B", "–", "+0.100 ± 0.000 (p = 0.500, n = 2)"],
        [0, "A − C", "+0.200 ± 0.100 (p = 0.250)", "–"],
    ]


def test_samplers_are_compared_method_by_method() -> None:
    """The second sampler is 0.1 better with A, 0.2 worse with B; the first one is what it is compared with."""
    first = scores_of(
        {
            ("csl", "proposed", 20, 0, "EAR"): [0.5, 0.6, 0.7],
            ("csl", "no_mec2", 20, 0, "EAR"): [0.5, 0.6, 0.7],
        }
    )
    shift = first["method"].map({"proposed": 0.1, "no_mec2": -0.2})
    both = pd.concat(
        [first.assign(sampler="published"), first.assign(sampler="mixing", value=first["value"] + shift)]
    )
    found = differences(both, ("EAR",), "sampler")
    assert found[["method", "sampler", "other", "compared"]].to_numpy().tolist() == [
        ["proposed", "mixing", "published", "sampler"],
        ["no_mec2", "mixing", "published", "sampler"],
    ]
    assert found["mean"].tolist() == pytest.approx([0.1, -0.2])
    assert readable_differences(found, ("EAR",), "sampler").to_numpy().tolist() == [
        [0, "(A) proposed", "mixing − published", "+0.100 ± 0.000 (p = 0.250)"],
        [0, "(B) w/o MEC-II", "mixing − published", "−0.200 ± 0.000 (p = 0.250)"],
    ]
    assert differences(first, ("EAR",), "sampler").empty
    # Samplers come as the study has them, not by the alphabet.
    assert differences(both, ("EAR",))["sampler"].tolist() == ["published", "mixing"]


def test_a_study_of_one_method_has_no_differences() -> None:
    found = differences(scores_of({("csl", "proposed", 20, 0, "EAR"): [0.3, 0.9]}), ("EAR",))
    assert found.empty
    assert readable_differences(found, ("EAR",)).empty
