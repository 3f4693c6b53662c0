"""The samplers side by side on feature files.

`python -m benchmarks.samplers --out DIR TRIALS OBJECTS [TRIALS OBJECTS …]` reads pairs of feature files with their
truth and writes comparison.csv (one row per fit) and comparison.md (means over the seeds) with EAR, ARI, the log
joint, effective samples of the log joint per second of processor time, and R-hat of the log joint over the seeds.
"""

from __future__ import annotations

import sys
import time
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.cases import SAMPLERS
from benchmarks.feature_files import parser_of, read_pairs
from benchmarks.summary import markdown
from evaluation.learned import Learned
from evaluation.measures import measured
from features.table import FeatureTable
from model import METHODS, Collapsed, Fit, Prior, Problem, Sampler, Trials, fit
from model.data import Floats
from model.diagnostics import diagnose
from model.omission import kept_words

Row = dict[str, object]
MEASURES = ("EAR", "ARI_a", "ARI_p", "ARI_o", "ARI_c")


def fit_and_measure(
    table: FeatureTable, ROW: int, method: str, name: str, sampler: Sampler[Any], seed: int
) -> tuple[Row, Fit]:
    """One fit and its measures; the same words are omitted for all methods and samplers of a seed."""
    trials = Trials.from_arrays(**table.learning_input())
    kept = kept_words(np.random.default_rng([seed, trials.count]), len(trials.word_trial), ROW)
    names = [channel.name for channel in trials.channels]
    priors = [Prior(box=(-0.5, 0.5) if channel == "position" else (0.0, 1.0)) for channel in names]
    problem = Problem.of(trials.keep_words(kept), method, priors)
    began = time.process_time()
    result = fit(problem, sampler, np.random.default_rng([seed, 7]))
    seconds = time.process_time() - began
    words = {channel: list(getattr(table, f"truth_{channel}")) for channel in names}
    measures = measured("csl", Learned(result, table), words)
    row: Row = {"D": trials.count, "ROW": ROW, "method": method, "sampler": name, "seed": seed}
    row |= {measure: measures[measure] for measure in MEASURES}
    row |= {"log_joint": result.trace_log_joint[-1], "seconds": seconds}
    # Of the second half of the chain, which is what it may be used for, in the time of the whole.
    size = diagnose({"log_joint": late(result)[None]})[0].ess_bulk
    row["ess_per_second"] = None if size is None else size / seconds
    return row, result


def late(fit: Fit) -> Floats:
    """The log joint along the second half of the chain."""
    return fit.trace_log_joint[len(fit.trace_log_joint) // 2 :]


def as_markdown(rows: pd.DataFrame) -> str:
    """Means over the seeds."""
    keys = ["D", "ROW", "method", "sampler"]
    numbers = [column for column in rows.columns if column not in (*keys, "seed")]
    means = rows.groupby(keys, sort=False)[numbers].mean().reset_index()
    formats = {"log_joint": "{:.0f}", "seconds": "{:.2f}", "ess_per_second": "{:.0f}", "r_hat": "{:.1f}"}
    for name in numbers:
        means[name] = means[name].map(formats.get(name, "{:.2f}").format, na_action="ignore").fillna("")
    return markdown(list(means.columns), means.astype(str).itertuples(index=False, name=None))


def main() -> None:
    """Compare and write."""
    parser = parser_of("benchmarks.samplers", __doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--row", type=int, nargs="+", default=[0, 40], help="rates of omitted words, per cent")
    parser.add_argument("--best", action="store_true", help="also the best of eight annealed collapsed chains")
    arguments = parser.parse_args()
    samplers = dict(SAMPLERS)
    if arguments.best:
        samplers["collapsed, best of 8, annealed from 5"] = Collapsed(chains=8, temperature=5.0)
    tables = read_pairs(parser, arguments.files)
    arguments.out.mkdir(parents=True, exist_ok=True)
    for named in samplers.items():  # Compiled code is loaded before the clock runs.
        fit_and_measure(tables[0], 0, "proposed", *named, 0)
    rows = []
    methods = [name for name, method in METHODS.items() if method.hears_words and method.is_model]
    for table, ROW, method, name in product(tables, arguments.row, methods, samplers):
        seeds = range(1, arguments.seeds + 1)
        new, fits = zip(
            *(fit_and_measure(table, ROW, method, name, samplers[name], seed) for seed in seeds), strict=True
        )
        # With words omitted, each seed has a posterior of its own.
        r_hat = diagnose({"log_joint": np.stack([late(one) for one in fits])})[0].r_hat if ROW == 0 else None
        rows += [row | {"r_hat": r_hat} for row in new]
        sys.stderr.write(f"{new[0]['D']} trials, ROW {ROW}, {method}, {name}\n")
    frame = pd.DataFrame(rows)
    frame.to_csv(arguments.out / "comparison.csv", index=False, float_format="%.6g")
    (arguments.out / "comparison.md").write_text(as_markdown(frame))


if __name__ == "__main__":
    main()
