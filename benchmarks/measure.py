"""Measure fits, each in a process of its own, so that peak memory is its own."""

from __future__ import annotations

import multiprocessing
import re
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.cases import SAMPLERS, Case, make_trials


@dataclass(frozen=True)
class Measurement:
    """What a fit took.

    Attributes:
        seconds: Wall-clock time of the fastest of the repetitions, imports and compilation left out.
        processor_seconds: Processor time of the fastest; on a busy machine it tells more.
        peak_mebibytes: Largest resident memory of the whole process.
        baseline_mebibytes: The same before the fit: Python, NumPy, Numba and the data.
    """

    seconds: float
    processor_seconds: float
    peak_mebibytes: float
    baseline_mebibytes: float


def measure(case: Case) -> Measurement:
    """Run a case in a new process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_measure_here, (case,))


def as_row(case: Case, result: Measurement) -> dict[str, object]:
    """A row of the table of results, seconds per iteration included."""
    row = {
        **asdict(case),
        "dimensions": " ".join(str(dim) for dim in case.dimensions),
        **asdict(result),
    }
    row["seconds_per_iteration"] = result.seconds / case.iterations
    row["processor_seconds_per_iteration"] = result.processor_seconds / case.iterations
    return row


def _measure_here(case: Case) -> Measurement:
    from model import Prior, Problem, fit

    problem = Problem.of(make_trials(case), case.method, Prior(categories=case.categories))

    def run(iterations: int) -> None:
        sampler = SAMPLERS[case.sampler].model_copy(update={"iterations": iterations, "keep_history": 0})
        fit(problem, sampler, np.random.default_rng(1))

    run(1)  # Loads the compiled code.
    baseline = _peak()
    wall, processor = [], []
    for _ in range(case.repetitions):
        before = time.perf_counter(), time.process_time()
        run(case.iterations)
        wall.append(time.perf_counter() - before[0])
        processor.append(time.process_time() - before[1])
    return Measurement(min(wall), min(processor), _peak(), baseline)


def _peak() -> float:
    """Largest resident memory of this process so far, MiB.

    Not by getrusage, which a new process inherits from the one that started it.
    """
    status = Path("/proc/self/status").read_text(encoding="ascii")
    return float(re.findall(r"VmHWM:\s*(\d+) kB", status)[0]) / 1024.0
