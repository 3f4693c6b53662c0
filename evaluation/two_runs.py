"""Two runs of a study, data set by data set and cell by cell: which differ by more than their seeds explain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import false_discovery_control, ttest_ind_from_stats

from evaluation.claims.judging import NOT_RUN
from evaluation.data_sets import data_set_name
from evaluation.scores import CONDITION, read_scores
from evaluation.table_forms import number

CELL = [*(key for key in CONDITION if key != "seed"), "measure"]
_welch_test = partial(ttest_ind_from_stats, equal_var=False)
# The share of false alarms among the alarms.
RATE = 0.05

SAME, LAST_DIGITS, EXPLAINED = "the same", "the same but for the last digits", "explained by the seeds"
DIFFERS, UNKNOWN = "differs", "too few seeds to say"
# What rounding explains: digits that neither a table shows nor a test of significance feels.
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9
NONE = pd.Series(dtype=str)
ONE_ONLY = ("only in the results", "only in the reference")


@dataclass(frozen=True)
class Compared:
    """Two runs compared.

    Attributes:
        cells: One row for each cell of both runs, indexed by `CELL`: `mean`, `sd` and `n` of either run (`_results`,
            `_reference`), `p` and `verdict`.
        claims: The claims that both runs have decided or tried to, indexed by their number: the verdict of either.
    """

    cells: pd.DataFrame
    claims: pd.DataFrame

    @property
    def nothing_in_common(self) -> bool:
        """Whether no cell is in both runs."""
        return bool(self.cells["verdict"].isin(ONE_ONLY).all())

    @property
    def explained(self) -> bool:
        """Whether the seeds explain every difference in the cells that both runs have."""
        return not self.cells["verdict"].isin((DIFFERS, UNKNOWN)).any()

    @property
    def other_verdicts(self) -> pd.DataFrame:
        """The claims of which the runs say different things."""
        return self.claims[self.claims["results"] != self.claims["reference"]]

    def summary(self) -> str:
        """What people read: how many cells say what, and those that differ, the least probable first."""
        verdicts = self.cells["verdict"]
        kinds = (SAME, LAST_DIGITS, EXPLAINED, DIFFERS, UNKNOWN)
        counts = (f"{(verdicts == verdict).sum():6} {verdict}" for verdict in kinds)
        lines = [f"{(~verdicts.isin(ONE_ONLY)).sum()} cells are in both runs:", *counts]
        for verdict in (DIFFERS, UNKNOWN):
            chosen = self.cells[verdicts == verdict].sort_values("p", kind="stable")
            if len(chosen):
                lines += ["", f"{verdict}:", *(_line(cell) for _, cell in chosen.reset_index().iterrows())]
        for verdict in ONE_ONLY:
            chosen = self.cells[verdicts == verdict].reset_index()
            if len(chosen):
                lines += ["", f"{len(chosen)} cells are {verdict}:"]
                parts = chosen["measure"].groupby(chosen.apply(_place, axis=1))
                told = parts.agg(lambda measures: f"{len(measures)} of {', '.join(measures.unique())}")
                lines += [f"  {place}: {text}" for place, text in told.items()]
        if len(self.claims):
            same = len(self.claims) - len(self.other_verdicts)
            lines += ["", f"{len(self.claims)} claims are in both runs, {same} of them with the same verdict"]
            lines += [
                f"  claim {one.Index}: {one.results} against {one.reference}"
                for one in self.other_verdicts.itertuples()
            ]
        return "\n".join(lines) + "\n"


def compare_folders(results: Path, reference: Path) -> Compared:
    """Compare the `scores.csv` of two output folders, and the verdicts of their `claims.csv` where both have one.

    Raises:
        FileNotFoundError: One has no `scores.csv`.
        ValueError: One is no file of scores.
    """
    paths = [folder / "scores.csv" for folder in (results, reference)]
    missing = [str(path) for path in paths if not path.is_file()]
    if missing:
        raise FileNotFoundError(f"no file {', '.join(missing)}: `make study` writes it")
    ours, theirs = (read_scores([path]) for path in paths)
    return compare(ours, theirs, *(_verdicts(folder / "claims.csv") for folder in (results, reference)))


def _verdicts(path: Path) -> pd.Series[str]:
    """The verdicts of a `claims.csv` by the number of the claim, without those of claims that were not run."""
    if not path.is_file():
        return NONE
    claims = pd.read_csv(path, index_col="claim", usecols=["claim", "verdict"])["verdict"]
    return claims[claims != NOT_RUN]


def compare(
    results: pd.DataFrame,
    reference: pd.DataFrame,
    verdicts: pd.Series[str] = NONE,
    other_verdicts: pd.Series[str] = NONE,
) -> Compared:
    """Compare the scores of two runs, cell by cell, where each data set has cells of its own: its data are the same.

    The seeds explain a difference of means that their spread makes likely, by Welch's t test. The test is not paired,
    because any change in the pipeline gives a seed another chain, and because a small shift of every seed within
    their spread is no finding. Some of the many cells have a small p by chance, so Benjamini and Hochberg's procedure
    decides, at a rate of 5 %: if nothing but the chains has changed, 5 % of the comparisons raise a false alarm.

    A cell is the same if every seed has the same value in both runs, or if it is undefined in both; it may be so but
    for the last digits. It differs if it is undefined in one run only, and if the means differ without any spread.
    One seed alone has no known spread: if its value is not the same, nobody can say.
    """
    runs = {"results": results, "reference": reference}
    statistics = [
        run.groupby(CELL)["value"].agg(mean="mean", sd="std", n="count", rows="size").add_suffix(f"_{name}")
        for name, run in runs.items()
    ]
    cells = statistics[0].join(statistics[1], how="outer")
    both = cells["rows_results"].notna() & cells["rows_reference"].notna()
    cells["p"] = _welch(cells)
    cells["verdict"] = np.where(cells["rows_results"].notna(), *ONE_ONLY)
    same, nearly = (
        both & _equal(results, reference, *tolerance).reindex(cells.index, fill_value=False)
        for tolerance in ((0.0, 0.0), (_RELATIVE, _ABSOLUTE))
    )
    same |= both & (cells["n_results"] == 0) & (cells["n_reference"] == 0)
    undefined = (cells["n_results"] == 0) != (cells["n_reference"] == 0)
    alike = same | nearly
    tested = both & ~alike & cells["p"].notna()
    alarm = pd.Series(False, index=cells.index)
    # Cells that are the same are tests as well, with p = 1.
    p = cells["p"].where(~alike, 1.0)[alike | tested]
    if len(p):
        alarm[p.index] = false_discovery_control(p) <= RATE
    cells.loc[both, "verdict"] = UNKNOWN
    cells.loc[tested, "verdict"] = EXPLAINED
    cells.loc[both & (alarm | undefined), "verdict"] = DIFFERS
    cells.loc[nearly, "verdict"] = LAST_DIGITS
    cells.loc[same, "verdict"] = SAME
    claims = pd.DataFrame({"results": verdicts, "reference": other_verdicts}).dropna()
    return Compared(cells.drop(columns=["rows_results", "rows_reference"]), claims)


def _equal(results: pd.DataFrame, reference: pd.DataFrame, relative: float, absolute: float) -> pd.Series[bool]:
    """Whether both runs have the same seeds and values, by cell, within a tolerance."""
    keys = [*CELL, "seed"]
    joined = results[[*keys, "value"]].merge(reference[[*keys, "value"]], on=keys, how="outer", indicator=True)
    equal = np.isclose(joined["value_x"], joined["value_y"], rtol=relative, atol=absolute, equal_nan=True)
    return joined.assign(same=equal & (joined["_merge"] == "both")).groupby(CELL)["same"].all()


def _welch(cells: pd.DataFrame) -> pd.Series[float]:
    """The two-sided p of Welch's t test; NaN where a run has less than two seeds."""
    arguments = (
        cells[f"{statistic}_{name}"].to_numpy(float)
        for name in ("results", "reference")
        for statistic in ("mean", "sd", "n")
    )
    with np.errstate(all="ignore"):  # no spread, or no seed
        p = pd.Series(_welch_test(*arguments).pvalue, index=cells.index)
    constant = (cells["sd_results"] == 0) & (cells["sd_reference"] == 0)
    equal = np.isclose(cells["mean_results"], cells["mean_reference"], rtol=1e-10, atol=1e-12)
    return p.mask(constant, equal.astype(float))


def _place(cell: pd.Series[str]) -> str:
    name = data_set_name(cell["experiment"], int(cell["dataset"]))
    return f"{name} {cell['variant']} {cell['sampler']} {cell['task']} D {cell['D']}"


def _line(cell: pd.Series[str]) -> str:
    sides = (
        f"{number(float(cell[f'mean_{name}']))} ± {number(float(cell[f'sd_{name}']))} (n = {cell[f'n_{name}']:.0f})"
        for name in ("results", "reference")
    )
    where = f"{_place(cell)} ROW {cell['ROW']} {cell['method']} {cell['measure']}"
    return f"  {where}: {' against '.join(sides)}, p = {number(float(cell['p']), '.2g')}"
