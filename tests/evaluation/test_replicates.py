"""Data sets first, seeds within them second: means, spreads and the hierarchical bootstrap on known cases."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from evaluation.catalogue import Table
from evaluation.claims.judging import Cell, Comparison, Sum, judge
from evaluation.claims.verdicts import judge_claims
from evaluation.differences import differences
from evaluation.effects import effects
from evaluation.replicates import RESAMPLES, bootstrap, sets_needed, statistics, units
from evaluation.scores import UNITS
from evaluation.table_forms import files
from evaluation.tables import sheet_of_scores, summarise
from evaluation.variance import pooled, variance_split
from tests.evaluation.hand_made import scores_of
from tests.evaluation.test_claims import as_the_paper_says, descriptions, results

SETS, SEEDS = 12, 5
# Data sets lie apart by 1, seeds by 0.2; every value is its own.
RNG = np.random.default_rng(5)
VALUES = RNG.normal(0.0, 1.0, (SETS, 1)) + RNG.normal(0.0, 0.2, (SETS, SEEDS))


def series(values: np.ndarray) -> pd.Series[float]:
    places = pd.MultiIndex.from_product([range(1, size + 1) for size in values.shape], names=UNITS)
    return pd.Series(values.ravel(), places)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_the_bootstrap_has_the_spread_that_arithmetic_gives() -> None:
    """Var = var(means of data sets) / S + mean(var of seeds) / (S n), with population variances."""
    draws = bootstrap([series(VALUES)], rng())
    between, within = VALUES.mean(axis=1).var(), VALUES.var(axis=1).mean()
    expected = np.sqrt(between / SETS + within / (SETS * SEEDS))
    assert draws.shape == (RESAMPLES,)
    assert draws.std() == pytest.approx(expected, rel=0.03)
    assert draws.mean() == pytest.approx(VALUES.mean(), abs=3 * expected / np.sqrt(RESAMPLES))
    # Broken controls: all values in one pot, and seeds alone, are much too sure.
    assert np.sqrt(VALUES.var() / VALUES.size) < 0.6 * expected
    assert bootstrap([series(VALUES.reshape(1, -1))], rng()).std() < 0.6 * expected
    assert np.array_equal(draws, bootstrap([series(VALUES)], rng()))


def test_data_sets_count_alike_however_many_seeds_they_have() -> None:
    """Two data sets, of one seed and of four: the means are 0, ½ and 1, drawn as ¼, ½ and ¼."""
    places = pd.MultiIndex.from_tuples([(1, 1), *((2, seed) for seed in (1, 2, 3, 4))], names=UNITS)
    values = pd.Series([0.0, 1.0, 1.0, 1.0, 1.0], places)
    shares = pd.Series(bootstrap([values], rng()).round(9)).value_counts(normalize=True)
    assert shares.to_dict() == pytest.approx({0.0: 0.25, 0.5: 0.5, 1.0: 0.25}, abs=0.02)
    assert units(values, True).mean() == 0.5


def test_parts_share_the_data_sets_and_not_the_seeds() -> None:
    """What is the data set's cancels in the difference of two D; what is the seed's does not."""
    of_set = np.repeat(VALUES[:, :1], SEEDS, axis=1)
    assert np.abs(bootstrap([series(of_set), series(-of_set)], rng())).max() < 1e-12
    assert bootstrap([series(VALUES), series(-VALUES)], rng()).std() > 0.01


def test_one_data_set_is_bootstrapped_as_seeds_alone_are() -> None:
    own = VALUES[:1]
    expected = own[0][rng().integers(SEEDS, size=(RESAMPLES, SEEDS))].mean(axis=1)
    assert np.array_equal(bootstrap([series(own)], rng()), expected)


A, B = (Sum(((1.0, Cell("simulator", 20, 0, "proposed", measure)),)) for measure in ("A", "B"))


def test_sharp_seeds_do_not_decide_where_data_sets_disagree() -> None:
    """Each data set is sure of its own difference: +0.1 in two, −0.1 in one."""
    higher = series(np.array([[0.60, 0.61], [0.60, 0.61], [0.40, 0.41]]))
    values = {A.terms[0][1]: higher, B.terms[0][1]: series(np.full((3, 2), 0.5))}
    judged = judge(Comparison(A, ">", B), values.__getitem__, rng())
    assert (judged.verdict, judged.datasets, judged.n) == ("not decidable", 3, 6)
    # 1.96 · sd / |mean| squared: sd 0.2 / √3, mean 0.115 / 3.
    assert judged.needed == np.ceil((1.96 * 0.2 / np.sqrt(3) / (0.115 / 3)) ** 2)
    one = {cell: own[own.index.get_level_values("dataset") == 1] for cell, own in values.items()}
    alone = judge(Comparison(A, ">", B), one.__getitem__, rng())
    assert (alone.verdict, alone.datasets, alone.needed) == ("holds", 1, None)


def test_a_data_set_of_more_seeds_counts_no_more_in_a_claim() -> None:
    places = pd.MultiIndex.from_tuples([(1, 1), *((2, seed) for seed in (1, 2, 3, 4))], names=UNITS)
    values = {A.terms[0][1]: pd.Series([0.0, 1.0, 1.0, 1.0, 1.0], places)}
    judged = judge(Comparison(A, ">", Sum()), values.__getitem__, rng())
    assert (judged.left, judged.difference, judged.n, judged.datasets) == (0.5, 0.5, 5, 2)


def test_the_number_of_data_sets_that_would_decide() -> None:
    differences_so_far = np.array([0.1, 0.3])
    sd = np.sqrt(0.02)
    assert sets_needed(differences_so_far, 0.05) == np.ceil((1.96 * sd / 0.05) ** 2)
    assert sets_needed(differences_so_far, 10.0) == 3
    assert sets_needed(differences_so_far, 0.0) == np.inf
    assert np.isnan(sets_needed(np.array([0.1]), 0.05))


def study(*by_set: list[float], other: float = 0.5) -> pd.DataFrame:
    """EAR of A in some data sets, over their seeds; B has the same everywhere."""
    parts = [
        scores_of(
            {
                ("csl", "proposed", 20, 0, "EAR"): own,
                ("csl", "no_mec2", 20, 0, "EAR"): [other] * len(own),
            },
            dataset=dataset,
        )
        for dataset, own in enumerate(by_set, 1)
    ]
    return pd.concat(parts, ignore_index=True)


TABLE = Table("A table", "simulator", ("csl",), 20)


def test_tables_are_over_data_sets() -> None:
    """Means 0.6, 0.8 and 1.0: 0.8 ± 0.2, whatever the seeds do within them."""
    scores = study([0.5, 0.7], [0.8, 0.8], [0.9, 1.1])
    summary = summarise(scores, ("EAR",)).iloc[0]
    assert (summary.EAR_mean, summary.EAR_sd) == pytest.approx((0.8, 0.2))
    assert (summary.datasets, summary.seeds, summary.EAR_n) == (3, 2, 6)
    sheet = sheet_of_scores(scores, TABLE)
    text = files(sheet)[".md"]
    assert "0.800 ± 0.200" in text
    assert "+0.300 ± 0.200" in text  # A − B
    assert "over the 3 data sets" in text
    assert "over the seeds" not in text.replace("mean over its seeds", "")


def test_tables_of_one_data_set_are_over_its_seeds() -> None:
    scores = study([0.5, 0.7])
    assert summarise(scores, ("EAR",)).iloc[0].EAR_sd == pytest.approx(np.sqrt(0.02))
    assert "over the seeds of one data set" in files(sheet_of_scores(scores, TABLE))[".md"]


def test_a_measure_that_one_data_set_alone_defines_has_no_spread() -> None:
    scores = study([0.5, 0.7], [np.nan, np.nan])
    (found,) = statistics(scores, ["method", "measure"]).query("method == 'proposed'").to_dict("records")
    assert (found["mean"], found["n"]) == (pytest.approx(0.6), 2)
    assert np.isnan(found["sd"])


def test_differences_and_effects_are_over_data_sets() -> None:
    scores = study([0.5, 0.7], [0.8, 0.8], [0.9, 1.1])
    (row,) = differences(scores, ("EAR",)).to_dict("records")
    assert (row["mean"], row["sd"], row["n"], row["datasets"]) == (pytest.approx(0.3), pytest.approx(0.2), 6, 3)
    assert row["p"] == 0.25  # three signs alike
    (effect,) = effects(scores).to_dict("records")
    assert (effect["mean"], effect["n"], effect["datasets"]) == (pytest.approx(0.3), 6, 3)
    assert effect["low"] < 0.15
    # Data sets count alike: 0.1 and 0.3, not the mean of three fits.
    assert effects(study([0.5, 0.7], [0.8]))["mean"].tolist() == pytest.approx([0.2])


def test_the_two_parts_of_the_variance() -> None:
    """Data sets 1 apart, seeds 0.2: the parts are found, and data sets that are alike have none."""
    apart = variance_split(study(*VALUES.tolist())).query("method == 'proposed'").iloc[0]
    within = VALUES.var(axis=1, ddof=1).mean()
    assert apart.within == pytest.approx(np.sqrt(within))
    assert apart["between"] == pytest.approx(np.sqrt(VALUES.mean(axis=1).var(ddof=1) - within / SEEDS))
    assert apart.share_between > 0.8
    assert (apart.datasets, apart.seeds) == (SETS, SEEDS)
    same = variance_split(study(*[VALUES[0].tolist()] * 3)).query("method == 'proposed'").iloc[0]
    assert (same["between"], same["share_between"]) == (0.0, 0.0)
    one = variance_split(study(VALUES[0].tolist()))
    assert one["between"].isna().all()
    assert pooled(one).empty
    shown = pooled(variance_split(study(*VALUES.tolist()))).set_index("method").loc["proposed"]
    assert (shown["between"], shown["within"]) == pytest.approx((apart["between"], apart["within"]))


def test_claims_are_over_data_sets() -> None:
    """B gains 0.3 in one of three data sets: no seed doubts it there; told is how many data sets would decide."""
    alone, parts = results(as_the_paper_says), []
    for dataset, shift in enumerate((0.0, 0.0, 0.3), 1):
        of_b = (alone["method"] == "no_mec2") & (alone["measure"] == "EAR")
        parts.append(alone.assign(dataset=dataset, value=alone["value"] + shift * of_b))
    told = pd.concat([descriptions().assign(dataset=dataset) for dataset in (1, 2, 3)], ignore_index=True)
    claims, comparisons = judge_claims(pd.concat(parts, ignore_index=True), told)
    claims = claims.set_index("claim")
    assert claims.loc[1, ["verdict", "datasets"]].tolist() == ["not decidable", 3]
    open_ones = comparisons[(comparisons["claim"] == 1) & (comparisons["verdict"] == "not decidable")]
    assert claims.loc[1, "needed"] == f"{open_ones['needed'].max():.0f}"
    assert claims.loc[7, ["verdict", "datasets", "needed"]].tolist() == ["holds", 3, ""]
    # One data set says so for sure, and nothing of how many it would take.
    one = judge_claims(alone, descriptions())[0].set_index("claim")
    assert one.loc[1, ["verdict", "datasets", "needed"]].tolist() == ["holds", 1, ""]
