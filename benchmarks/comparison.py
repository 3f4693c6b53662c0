"""Blocked, averaged and collapsed sampling side by side on feature files.

`python -m benchmarks.comparison --out DIR TRIALS OBJECTS [TRIALS OBJECTS …]` reads pairs of feature files with their
truth and writes comparison.csv (a row a fit) and comparison.md (means over the seeds) with EAR, ARI, the log joint,
effective samples of the log joint a second of processor time, and R-hat of the log joint over the seeds.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"

if TYPE_CHECKING:
    import pandas as pd

    from features.table import FeatureTable
    from model import Fit
    from model.data import Floats

Row = dict[str, object]
CHANNELS = ("action", "position", "object", "color")


@dataclass(frozen=True)
class Variant:
    """A sampler with its settings.

    Attributes:
        name: what the table calls it.
        arguments: of `model.fit`.
        settings: of `model.Settings`.
    """

    name: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)


VARIANTS = (
    Variant("blocked"),
    Variant("averaged", settings={"averaged_draws": 100, "empty_category": "uniform"}),
    Variant("collapsed", {"inference": "collapsed"}),
)
BEST = Variant("collapsed, best of 8, annealed from 5", {"inference": "collapsed", "chains": 8, "temperature": 5.0})


def compare(table: FeatureTable, ROW: int, method: str, variant: Variant, seed: int) -> tuple[Row, Fit]:
    """One fit and its measures; the same words are omitted for all methods and samplers of a seed."""
    import numpy as np

    from model import Prior, Settings, Trials, fit
    from model.diagnostics import diagnose
    from model.omission import kept_words

    trials = Trials.from_arrays(**table.learning_input())
    kept = kept_words(np.random.default_rng([seed, trials.count]), len(trials.word_trial), ROW)
    priors = [Prior(box=(-0.5, 0.5) if name == "position" else (0.0, 1.0)) for name in CHANNELS]
    began = time.process_time()
    result = fit(
        trials.keep_words(kept),
        method,
        np.random.default_rng([seed, 7]),
        priors,
        settings=Settings(**variant.settings),
        **variant.arguments,
    )
    seconds = time.process_time() - began
    row: Row = {"D": trials.count, "ROW": ROW, "method": method, "sampler": variant.name, "seed": seed}
    row |= measures(result, table) | {"log_joint": result.trace_log_joint[-1], "seconds": seconds}
    # Of the second half of the chain, which is what it may be used for, in the time of the whole.
    size = diagnose({"log_joint": late(result)[None]})[0].ess_bulk
    row["ess_per_second"] = None if size is None else size / seconds
    return row, result


def late(fit: Fit) -> Floats:
    """The log joint along the second half of the chain."""
    return fit.trace_log_joint[len(fit.trace_log_joint) // 2 :]


def measures(fit: Fit, table: FeatureTable) -> Row:
    """EAR, and ARI of each channel."""
    import numpy as np
    from sklearn.metrics import adjusted_rand_score

    from model import METHODS

    truth = {name: list(getattr(table, f"truth_{name}")) for name in CHANNELS}
    channel_of = {word: c for c, name in enumerate(CHANNELS) for word in truth[name]}
    result: Row = {"EAR": None}
    if METHODS[fit.method].has_frames and len(fit.state.F):
        true = [channel_of[fit.trials.vocabulary[w]] for w in fit.trials.words[0]]
        result["EAR"] = float(np.mean(fit.state.F == true))
    for c, name in enumerate(CHANNELS):
        result[f"ARI_{name}"] = float(adjusted_rand_score(truth[name], fit.state.z[c]))
    return result


def as_markdown(rows: pd.DataFrame) -> str:
    """Means over the seeds."""
    keys = ["D", "ROW", "method", "sampler"]
    numbers = [column for column in rows.columns if column not in (*keys, "seed")]
    means = rows.groupby(keys, sort=False)[numbers].mean().reset_index()
    formats = {"log_joint": "{:.0f}", "seconds": "{:.2f}", "ess_per_second": "{:.0f}", "r_hat": "{:.1f}"}
    lines = ["| " + " | ".join(means.columns) + " |", "| " + " | ".join("---" for _ in means.columns) + " |"]
    for _, row in means.iterrows():
        cells = [str(row[key]) for key in keys]
        cells += ["" if row[n] != row[n] else formats.get(n, "{:.2f}").format(row[n]) for n in numbers]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Compare and write."""
    import numpy as np
    import pandas as pd

    from features.table import read_table
    from model.diagnostics import diagnose

    parser = argparse.ArgumentParser(prog="python -m benchmarks.comparison", description=__doc__.split("\n")[0])
    parser.add_argument("files", type=Path, nargs="+", help="trials and objects, in turn")
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--row", type=int, nargs="+", default=[0, 40], help="rates of omitted words, per cent")
    parser.add_argument("--best", action="store_true", help="also the best of eight annealed collapsed chains")
    arguments = parser.parse_args()
    variants = (*VARIANTS, BEST) if arguments.best else VARIANTS
    if len(arguments.files) % 2:
        parser.error("feature files come in pairs: trials and objects")
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for variant in variants:  # Compiled code is loaded before the clock runs.
        compare(read_table(*arguments.files[:2], need_attention=True), 0, "proposed", variant, 0)
    for trials, objects in zip(arguments.files[::2], arguments.files[1::2], strict=True):
        table = read_table(trials, objects, need_attention=True)
        for ROW in arguments.row:
            for method in ("proposed", "no_mec2", "mmlda"):
                for variant in variants:
                    new, fits = zip(
                        *(compare(table, ROW, method, variant, seed) for seed in range(1, arguments.seeds + 1)),
                        strict=True,
                    )
                    # With words omitted, each seed has a posterior of its own.
                    r_hat = (
                        diagnose({"log_joint": np.stack([late(one) for one in fits])})[0].r_hat if ROW == 0 else None
                    )
                    rows += [row | {"r_hat": r_hat} for row in new]
                    sys.stderr.write(f"{new[0]['D']} trials, ROW {ROW}, {method}, {variant.name}\n")
    frame = pd.DataFrame(rows)
    frame.to_csv(arguments.out / "comparison.csv", index=False, float_format="%.6g")
    (arguments.out / "comparison.md").write_text(as_markdown(frame))


if __name__ == "__main__":
    main()
