"""How soon the samplers reach the posterior: the log joint and R-hat against processor time.

`python -m benchmarks.convergence --out DIR TRIALS OBJECTS [TRIALS OBJECTS …]` fits pairs of feature files by method
A, with every word, with each sampler and numbers of iterations that double. It writes convergence_time.csv (one row
per sampler and length), convergence_time.md (when each sampler reaches its goal) and convergence_time.png.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.cases import SAMPLERS
from benchmarks.feature_files import parser_of, read_pairs
from benchmarks.plots import draw_convergence
from benchmarks.summary import markdown, processor
from evaluation.convergence import GOAL
from features.table import FeatureTable
from model import Collapsed, Problem, Sampler, Trials, fit
from model.diagnostics import chain_quantities, diagnose

_PAGE = """# Time to the posterior

Written by `python -m benchmarks.convergence`. {processor}; processor seconds of a fit, the mean of {chains} from
different starts, by method A with every word. R-hat is over these fits, of the second half of each: of the log joint,
and the largest over the numbers of categories in use. The goal is below {goal}; where no length that was tried
reaches it, the R-hat of the longest stands in brackets. "{best}" is the best of eight annealed chains, one fit; its
seconds are those of all eight.

{table}
![The log joint and R-hat against seconds](convergence_time.png)
"""


@dataclass(frozen=True)
class Runner:
    """A sampler, and the iterations that it is tried with.

    Attributes:
        sampler: With all settings but the iterations.
        lengths: Numbers of iterations, rising.
    """

    sampler: Sampler[Any]
    lengths: tuple[int, ...]


BEST = "collapsed, best of 8"
RUNNERS = {
    "published": Runner(SAMPLERS["published"], (50, 100, 200, 400, 800, 1600, 3200, 6400)),
    "collapsed": Runner(SAMPLERS["collapsed"], (50, 100, 200, 400, 800, 1600, 3200)),
    BEST: Runner(Collapsed(chains=8, temperature=5.0), (25, 50, 100, 200, 400)),
    "mixing": Runner(SAMPLERS["mixing"], (25, 50, 100, 200, 400, 600, 800, 1600)),
}


def measure(table: FeatureTable, name: str, iterations: int, chains: int) -> dict[str, object]:
    """The fits of one sampler and length: what they take, and whether they agree."""
    problem = Problem.of(Trials.from_arrays(**table.learning_input()), "proposed")
    sampler = RUNNERS[name].sampler.model_copy(update={"iterations": iterations, "keep_history": 1})
    began = time.process_time()
    fits = [fit(problem, sampler, np.random.default_rng([chain, 11])) for chain in range(chains)]
    seconds = (time.process_time() - began) / chains
    quantities = chain_quantities(fits)
    r_hat = {one.quantity: one.r_hat for one in diagnose(quantities)}
    used = [value for quantity, value in r_hat.items() if quantity.startswith("used_") and value is not None]
    means = quantities["log_joint"].mean(axis=1)
    return {
        "D": problem.trials.count,
        "sampler": name,
        "iterations": iterations,
        "seconds": seconds,
        "log_joint": means.mean(),
        "lowest": means.min(),
        "r_hat": r_hat["log_joint"],
        "r_hat_used": max(used, default=1.0),
    }


def reached(rows: pd.DataFrame) -> Iterator[list[str]]:
    """For each data set and sampler: the seconds from which on all lengths reach the goal, and the log joint then."""
    for (D, sampler), own in rows.groupby(["D", "sampler"], sort=False):
        seconds, cells = own.seconds.to_list(), [str(D), str(sampler)]
        for column in ("r_hat", "r_hat_used"):
            values = own[column].to_list()
            after = max((n + 1 for n, value in enumerate(values) if not value < GOAL), default=0)
            never = f"({values[-1]:.2f} at {seconds[-1]:.1f})"
            cells.append(f"{seconds[after]:.2f}" if after < len(values) else never)
        highest = int(np.argmax(own.log_joint))
        cells += [f"{own.log_joint.iloc[highest]:.0f}", f"{own.lowest.iloc[highest]:.0f}", f"{seconds[highest]:.2f}"]
        yield cells


def main() -> None:
    """Measure, write, draw."""
    parser = parser_of("benchmarks.convergence", __doc__)
    parser.add_argument("--chains", type=int, default=8)
    parser.add_argument("--quick", action="store_true", help="the shortest two lengths, to see that it runs")
    arguments = parser.parse_args()
    tables = read_pairs(parser, arguments.files)
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for table in tables:
        for name, runner in RUNNERS.items():
            measure(table, name, 4, 1)  # Compiled code is loaded before the clock runs.
            for iterations in runner.lengths[:2] if arguments.quick else runner.lengths:
                rows.append(measure(table, name, iterations, arguments.chains))
                line = "{D} trials, {sampler}, {iterations} iterations: {seconds:.2f} s, R-hat {r_hat:.2f}"
                sys.stderr.write(line.format(**rows[-1]) + "\n")
    frame = pd.DataFrame(rows)
    frame.to_csv(arguments.out / "convergence_time.csv", index=False, float_format="%.6g")
    columns = [
        "D",
        "sampler",
        f"s to R-hat < {GOAL}",
        "of categories in use",
        "highest log joint",
        "lowest fit",
        "at s",
    ]
    page = _PAGE.format(
        processor=processor(),
        chains=arguments.chains,
        goal=GOAL,
        best=BEST,
        table=markdown(columns, reached(frame)),
    )
    (arguments.out / "convergence_time.md").write_text(page, encoding="utf-8")
    draw_convergence(frame, arguments.out / "convergence_time.png")


if __name__ == "__main__":
    main()
