"""The lights: each rule on diagnoses made by hand, and what tables and claims say of them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from evaluation.convergence import (
    AMBER,
    BY_CHANCE,
    ENOUGH,
    GOAL,
    GREEN,
    RED,
    TOLERATED,
    UNCHECKED,
    beside_truth,
    chance_r_hat,
    counted,
    distrust,
    light_of,
    lights,
    read_diagnoses,
    read_lights,
)
from evaluation.scores import SEEDS, write_csv
from model.diagnostics import diagnose
from tests.evaluation.hand_made import Values, scores_of

NAN, INF = float("nan"), float("inf")
# Log joints of three seeds beside the truth's, which is defined for two of them, and of a method for which it is not.
TRUTH: Values = {
    ("csl", "proposed", 5, 0, "log_joint"): [10.0, 2.0, -5.0],
    ("csl", "proposed", 5, 0, "log_joint_truth"): [7.0, 5.5, NAN],
    ("csl", "mmlda", 5, 0, "log_joint"): [10.0, 2.0, -5.0],
    ("csl", "mmlda", 5, 0, "log_joint_truth"): [NAN, NAN, NAN],
    ("csl", "proposed", 5, 20, "log_joint"): [9.0],
    ("csl", "proposed", 5, 20, "log_joint_truth"): [5.0],
    ("csl", "proposed", 5, 20, "EAR"): [1.0],
}


def diagnoses(chains: int = 4, draws: int = 500, ess: float = 400.0, **r_hats: float) -> pd.DataFrame:
    """Diagnoses of quantities with these R-hats; None says that a quantity is the same everywhere."""
    rows = [
        {
            "quantity": name,
            "mean": 1.0,
            "sd": 0.0 if r_hat is None else 1.0,
            "r_hat": NAN if r_hat is None else r_hat,
            "ess_bulk": NAN if r_hat is None else ess,
            "ess_tail": NAN,
            "chains": chains,
            "draws": draws,
        }
        for name, r_hat in r_hats.items()
    ]
    return pd.DataFrame(rows)


@pytest.mark.parametrize(
    ("light", "worst", "found"),
    [
        (GREEN, "used_color", diagnoses(log_joint=1.01, used_color=1.04)),
        (AMBER, "used_color", diagnoses(log_joint=1.01, used_color=GOAL)),
        (AMBER, "word_color_red", diagnoses(log_joint=1.06, word_color_red=1.19)),
        (RED, "word_color_red", diagnoses(log_joint=1.0, word_color_red=TOLERATED)),
        (RED, "frame_color", diagnoses(log_joint=3.0, frame_color=INF)),
        # The log joint has to have enough draws, of all chains together.
        (GREEN, "log_joint", diagnoses(log_joint=1.01, ess=ENOUGH)),
        (AMBER, "log_joint", diagnoses(log_joint=1.01, used_color=1.04, ess=ENOUGH - 1)),
        (AMBER, "log_joint", diagnoses(log_joint=1.01, ess=NAN)),
        # What is the same in all chains does not count, and pairs do not decide.
        (GREEN, "log_joint", diagnoses(log_joint=1.01, used_color=None)),
        (GREEN, "log_joint", diagnoses(log_joint=1.01, same_color_0_1=INF)),
        # What changes but cannot be told is no reason to trust.
        (AMBER, "words", diagnoses(log_joint=1.01, words=NAN)),
    ],
)
def test_each_rule(light: str, worst: str, found: pd.DataFrame) -> None:
    told = light_of(found)
    assert (told["light"], told["worst"]) == (light, worst)
    assert told["log_joint_r_hat"] == found.r_hat[0]


def test_chains_that_never_change_agree_or_do_not() -> None:
    same, apart = np.full((2, 50), 3.0), np.repeat([[3.0], [4.0]], 50, axis=1)
    walk = np.random.default_rng(0).normal(size=(2, 50))
    for used, light in ((same, GREEN), (apart, RED)):
        found = pd.DataFrame([vars(one) for one in diagnose({"log_joint": walk, "used_color": used})])
        found.loc[0, ["r_hat", "ess_bulk"]] = 1.0, ENOUGH
        assert light_of(found.astype({"r_hat": float}))["light"] == light
    still = pd.DataFrame([vars(one) for one in diagnose({"log_joint": same})]).astype({"r_hat": float})
    told = light_of(still)
    assert (told["light"], told["worst"]) == (GREEN, "")
    assert math.isnan(told["r_hat"])


def test_one_chain_is_not_checked() -> None:
    told = light_of(diagnoses(chains=1, log_joint=NAN, used_color=None))
    assert (told["light"], told["worst"], told["chains"]) == (UNCHECKED, "", 1)


def test_few_draws_turn_red_only_beyond_chance() -> None:
    log_joint, limit = diagnoses(log_joint=1.01), chance_r_hat(4, 10)
    assert limit > TOLERATED
    for r_hat, light in ((limit - 0.01, AMBER), (limit + 0.01, RED)):
        kept = diagnoses(draws=10, word_color_red=r_hat)
        assert light_of(pd.concat([log_joint, kept]))["light"] == light
    assert chance_r_hat(10, 50) < GOAL


@pytest.mark.parametrize(("chains", "draws"), [(2, 10), (4, 10), (4, 50)])
def test_chance_is_as_rare_as_it_is_said_to_be(chains: int, draws: int) -> None:
    rng, limit, times = np.random.default_rng(0), chance_r_hat(chains, draws), 500
    found: NDArray[np.float64] = np.array(
        [diagnose({"": rng.normal(size=(chains, draws))})[0].r_hat for _ in range(times)]
    )
    # So many of 500 are improbable (1 in 10,000) if each has the probability of 1 in 1,000.
    assert (found > limit).sum() <= 6
    # A tenth of them are nearer to it than a limit that were far too high would have any.
    assert np.quantile(found, 0.9) > 1 + 0.15 * (limit - 1)
    assert BY_CHANCE * times < 1


def study(tmp_path: Path, *conditions: tuple[str, str, int, str]) -> pd.DataFrame:
    """The lights of (method, sampler, ROW, light), written and read."""
    r_hats = {GREEN: 1.0, AMBER: 1.1, RED: 2.0, UNCHECKED: NAN}
    parts = []
    for method, sampler, ROW, light in conditions:
        names = {
            "experiment": "NA",
            "dataset": 1,
            "variant": "default",
            "D": 5,
            "method": method,
            "sampler": sampler,
            "ROW": ROW,
        }
        parts.append(diagnoses(1 if light == UNCHECKED else 4, log_joint=r_hats[light]).assign(**names))
    for i, part in enumerate(parts):
        write_csv(part, tmp_path / f"{i}.csv")
    found = lights(read_diagnoses(tmp_path / f"{i}.csv" for i in range(len(parts))))
    write_csv(beside_truth(found, scores_of(TRUTH, experiment="NA")), tmp_path / "convergence.csv")
    return read_lights(tmp_path / "convergence.csv")


def test_a_row_for_each_condition_that_can_be_read_again(tmp_path: Path) -> None:
    found = study(tmp_path, ("mmlda", "long", 0, RED), ("proposed", "long", 0, UNCHECKED))
    assert list(found.columns[: len(SEEDS)]) == SEEDS
    assert found[["experiment", "method", "light"]].to_numpy().tolist() == [
        ["NA", "proposed", UNCHECKED],
        ["NA", "mmlda", RED],
    ]
    assert found.worst.tolist() == ["", "log_joint"]
    assert counted(found.light) == "1 red, 1 not checked"


def test_the_seed_farthest_below_the_truth_is_told_and_decides_nothing(tmp_path: Path) -> None:
    conditions = [("proposed", ROW, GREEN) for ROW in (0, 20, 40)] + [("mmlda", 0, GREEN)]
    found = study(tmp_path, *((method, "published", ROW, light) for method, ROW, light in conditions))
    told = dict(zip(zip(found.method, found.ROW, strict=True), found.below_truth, strict=True))
    expected = {("proposed", 0): 3.5, ("proposed", 20): -4.0, ("proposed", 40): NAN, ("mmlda", 0): NAN}
    assert told == pytest.approx(expected, nan_ok=True)
    assert set(found.light) == {GREEN}


def test_a_table_says_which_of_its_numbers_not_to_trust(tmp_path: Path) -> None:
    conditions = [
        *(("proposed", "published", ROW, RED) for ROW in (0, 20)),
        ("mmlda", "published", 0, AMBER),
        ("mmlda", "published", 20, RED),
        *((method, "mixing", 0, GREEN) for method in ("proposed", "mmlda")),
        *((method, "short", 0, UNCHECKED) for method in ("proposed", "mmlda")),
    ]
    found = study(tmp_path, *conditions)
    note = distrust(found, found)
    assert note == (
        "Not converged (red light), so that numbers say what the sampler found rather than what the model says: "
        "of sampler published, (A) proposed at ROW 0, 20 and (C) mMLDA at ROW 20. "
        "Converged in part (amber light): of sampler published, (C) mMLDA at ROW 0. "
        "Not checked (one chain): all of sampler short. See diagnostics.html."
    )
    assert distrust(found[found["sampler"] == "mixing"], found) == (
        "Fits of every condition have converged (green light); see diagnostics.html."
    )
    assert distrust(found[:0], found) == ""
