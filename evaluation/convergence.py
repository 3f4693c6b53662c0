"""The gate of the study: from the diagnoses of a condition's chains to a light, and which numbers not to trust."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from math import isnan, sqrt
from pathlib import Path
from typing import Any

import pandas as pd

from evaluation.scores import LOG_JOINT, LOG_JOINT_TRUTH, SEEDS, in_order, varying
from model import METHODS
from model.diagnostics import PAIR

GREEN, AMBER, RED, UNCHECKED = "green", "amber", "red", "not checked"
# What a light says in a note, the worst first.
LIGHTS = {
    RED: "not converged (red light), so that numbers say what the sampler found rather than what the model says",
    AMBER: "converged in part (amber light)",
    UNCHECKED: "not checked (one chain)",
    GREEN: "converged (green light)",
}
# The study's own goals: R-hat of every quantity, and the bulk effective sample size of the log joint over all chains.
GOAL, ENOUGH = 1.05, 100
# From here on chains disagree: Brooks and Gelman (1998), of an R-hat that was neither split nor ranked.
TOLERATED = 1.2
# R-hat of few draws is large by chance; one that independent draws would exceed less often than this is not chance.
BY_CHANCE = 0.001


def chance_r_hat(chains: int, draws: int) -> float:
    """The R-hat that independent draws exceed with probability `BY_CHANCE`, in a quantity of their own.

    Of m half chains of n draws R-hat² is 1 + (F − 1)/n, and F, variance between over variance within, has an F
    distribution with m − 1 and m (n − 1) degrees of freedom. There are two, of ranks and of folded ranks.
    """
    from scipy.stats import f

    m, n = 2 * chains, draws // 2
    return sqrt(1 + (float(f.ppf(1 - BY_CHANCE / 2, m - 1, m * (n - 1))) - 1) / n)


def light_of(diagnoses: pd.DataFrame) -> dict[str, Any]:
    """The light of one condition, by the rules that `templates/lights.html` tells, and what decided it.

    Args:
        diagnoses: A row for each quantity, with the fields of `model.diagnostics.Diagnosis`.

    Returns:
        `chains`; `light`; `worst`, the quantity that speaks most against, and `r_hat`, what it has; `log_joint_r_hat`
        and `log_joint_ess`, which is that of the bulk. `worst` is empty where no quantity has an R-hat.
    """
    judged = diagnoses[~diagnoses.quantity.str.startswith(PAIR)]
    chains = int(judged.chains.iloc[0])
    log_joint = judged[judged.quantity == "log_joint"].iloc[0]
    grades = [_grade(*values) for values in zip(judged.sd, judged.r_hat, judged.chains, judged.draws, strict=True)]
    order = judged.assign(grade=grades).sort_values(["grade", "r_hat"], ascending=False, kind="stable")
    worst = order.iloc[0]
    light = (GREEN, AMBER, RED)[int(worst.grade)]
    if light == GREEN and log_joint.sd > 0 and not log_joint.ess_bulk >= ENOUGH:
        light, worst = AMBER, log_joint
    known = chains > 1 and worst.sd != 0
    return {
        "chains": chains,
        "light": light if chains > 1 else UNCHECKED,
        "worst": worst.quantity if known else "",
        "r_hat": worst.r_hat if known else float("nan"),
        "log_joint_r_hat": log_joint.r_hat,
        "log_joint_ess": log_joint.ess_bulk,
    }


def _grade(sd: float, r_hat: float, chains: int, draws: int) -> int:
    """What a quantity says: 0 nothing against, 1 not enough for trust, 2 that chains disagree."""
    if sd == 0:
        return 0
    if isnan(r_hat):
        return 1
    if r_hat < GOAL:
        return 0
    return 1 if r_hat < max(TOLERATED, chance_r_hat(chains, draws)) else 2


def lights(diagnoses: pd.DataFrame) -> pd.DataFrame:
    """The light of each condition: columns `SEEDS`, then those of `light_of`.

    Args:
        diagnoses: A row for each condition and quantity, as in `diagnostics.csv`.
    """
    rows = [
        dict(zip(SEEDS, names, strict=True)) | light_of(own) for names, own in diagnoses.groupby(SEEDS, sort=False)
    ]
    return in_order(pd.DataFrame(rows), SEEDS)


def beside_truth(found: pd.DataFrame, scores: pd.DataFrame) -> pd.DataFrame:
    """The lights with a column `below_truth`: by how many nats the fits of a condition are below the truth.

    Of the seeds, whose words differ, it is the one farthest below; negative where all are above. It does not decide:
    the posterior need not prefer the truth, and chains that have found the posterior may be above it.

    Args:
        found: The lights, see `lights`.
        scores: The measures of the fits. The column is missing (NaN) where the truth is no state of the method.
    """
    own = scores[scores.measure.isin([LOG_JOINT, LOG_JOINT_TRUTH])]
    values = own.pivot(index=[*SEEDS, "seed"], columns="measure", values="value").reindex(
        columns=[LOG_JOINT, LOG_JOINT_TRUTH]
    )
    below = (values[LOG_JOINT_TRUTH] - values[LOG_JOINT]).groupby(level=SEEDS).max()
    return found.merge(below.rename("below_truth"), how="left", left_on=SEEDS, right_index=True)


def read_diagnoses(paths: Iterable[Path]) -> pd.DataFrame:
    """Read and join files of diagnoses."""
    return pd.concat([_read(path, ("mean", "sd", "r_hat", "ess_bulk", "ess_tail")) for path in paths])


def read_lights(path: Path) -> pd.DataFrame:
    """Read `convergence.csv`; `worst` is empty where no quantity has an R-hat."""
    return _read(path, ("r_hat", "log_joint_r_hat", "log_joint_ess", "below_truth"))


def _read(path: Path, numbers: tuple[str, ...]) -> pd.DataFrame:
    """Read a table in which names may be what pandas would take for a missing number, such as NA."""
    return pd.read_csv(path, keep_default_na=False, na_values=dict.fromkeys(numbers, ""))


def counted(found: Iterable[str]) -> str:
    """How many lights there are of each color, the worst first, as in `3 red, 1 green`."""
    counts = Counter(found)
    return ", ".join(f"{counts[light]} {light}" for light in LIGHTS if light in counts)


def distrust(shown: pd.DataFrame, convergence: pd.DataFrame) -> str:
    """What the note of a table says of the fits that its rows rest on; of a condition the worst of its data sets.

    Args:
        shown: Rows with the columns `SEEDS`: of scores, or of answers.
        convergence: The lights of the study.
    """
    conditions = _worst_of_sets(shown[SEEDS].drop_duplicates().merge(convergence, on=SEEDS))
    if conditions.empty:
        return ""
    if (conditions.light == GREEN).all():
        return f"Fits of every condition have {LIGHTS[GREEN]}; see diagnostics.html."
    said = [
        f"{meaning[0].upper()}{meaning[1:]}: {'; '.join(_places(conditions, light))}."
        for light, meaning in LIGHTS.items()
        if light != GREEN and (conditions.light == light).any()
    ]
    return " ".join([*said, "See diagnostics.html."])


def _worst_of_sets(conditions: pd.DataFrame) -> pd.DataFrame:
    """One row for each condition, with the worst light of its data sets."""
    keys = [key for key in SEEDS if key != "dataset"]
    order = conditions.light.map(list(LIGHTS).index).sort_values(kind="stable").index
    return conditions.loc[conditions.index.isin(conditions.loc[order].drop_duplicates(keys).index)]


def _places(conditions: pd.DataFrame, light: str) -> Iterator[str]:
    """Where a light is on, a text for each sampler, variant and D: all conditions, or the ROW of each method."""
    keys = varying(conditions, ["variant", "D"])
    for names, group in conditions.groupby(["sampler", *keys], sort=False):
        own = group[group.light == light]
        where = ", ".join(
            [f"of sampler {names[0]}", *(f"{key} {name}" for key, name in zip(keys, names[1:], strict=True))]
        )
        if len(own) == len(group):
            yield f"all {where}"
        elif len(own):
            yield f"{where}, {' and '.join(_rates_by_method(own))}"


def _rates_by_method(conditions: pd.DataFrame) -> list[str]:
    rates = conditions.groupby("method", sort=False)["ROW"]
    return [f"{METHODS[str(method)].label} at ROW {', '.join(map(str, sorted(set(own))))}" for method, own in rates]
