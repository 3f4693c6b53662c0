"""Whether the fits that a claim rests on have converged."""

from __future__ import annotations

import pandas as pd

from evaluation.claims.judging import NOT_RUN
from evaluation.claims.paper import CLAIMS
from evaluation.claims.terms import Claim
from evaluation.claims.verdicts import SAMPLER
from evaluation.convergence import counted


def with_lights(claims: pd.DataFrame, convergence: pd.DataFrame) -> pd.DataFrame:
    """The claims with a column `lights`, behind the verdict: of the conditions that each rests on, as in `3 red`.

    A condition counts once for each data set.

    Args:
        claims: The rows of `claims.csv`, without that column.
        convergence: The lights of the study's conditions.
    """
    own = convergence[convergence["sampler"] == SAMPLER]
    light = own.groupby(["experiment", "variant", "D", "ROW", "method"])["light"].agg(list).to_dict()
    told = {
        claim.number: counted([each for one in _conditions(claim) for each in light.get(one, ())]) for claim in CLAIMS
    }
    verdicts = claims[["claim", "verdict"]].itertuples(index=False, name=None)
    result = claims.copy()
    result.insert(
        list(claims.columns).index("verdict") + 1,
        "lights",
        ["" if verdict == NOT_RUN else told[number] for number, verdict in verdicts],
    )
    return result


def _conditions(claim: Claim) -> set[tuple[str, str, int, int, str]]:
    cells = {cell for comparison in claim.comparisons for cell in comparison.cells}
    return {(cell.experiment, cell.variant, cell.D, cell.ROW, cell.method) for cell in cells}
