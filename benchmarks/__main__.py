"""Run the benchmarks: `python -m benchmarks --out DIR [--quick]`.

Writes fits.csv (time and memory of fits), kernels.csv (hot kernels against the peak of one core), scaling.png,
roofline.png, and summary.md, which sums them up. The progress goes to standard error.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.cases import all_cases
from benchmarks.kernels import measure_kernels, measure_machine
from benchmarks.measure import as_row, measure
from benchmarks.plots import draw_roofline, draw_scaling
from benchmarks.summary import summary


def main() -> None:
    """Measure, write, draw."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__.split("\n")[0])
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    parser.add_argument("--quick", action="store_true", help="small sizes, to see that it runs")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    rows, began = [], time.perf_counter()
    cases = list(all_cases(arguments.quick))
    for number, case in enumerate(cases, start=1):
        result = measure(case)
        rows.append(as_row(case, result))
        line = f"[{number}/{len(cases)}] {case.series} {case.size} {case.method} {case.sampler}"
        sys.stderr.write(f"{line}: {result.processor_seconds:.3f} s, {result.peak_mebibytes:.0f} MiB\n")
    fits = pd.DataFrame(rows)
    fits.to_csv(arguments.out / "fits.csv", index=False, float_format="%.6g")
    draw_scaling(fits, arguments.out / "scaling.png")

    machine = measure_machine()
    kernels = pd.DataFrame(list(measure_kernels(arguments.quick)))
    speed = kernels.flops / kernels.seconds
    kernels["gigaflops"] = speed / 1e9
    kernels["share_of_peak"] = speed / machine.peak
    kernels["share_of_roof"] = speed / np.minimum(machine.peak, machine.bandwidth * kernels.flops / kernels.bytes)
    kernels.to_csv(arguments.out / "kernels.csv", index=False, float_format="%.6g")
    draw_roofline(kernels, machine, arguments.out / "roofline.png")
    (arguments.out / "summary.md").write_text(summary(fits, kernels, machine), encoding="utf-8")
    sys.stderr.write(
        f"one core: {machine.peak / 1e9:.1f} · 10⁹ operations and {machine.bandwidth / 1e9:.1f} GB per second; "
        f"done in {time.perf_counter() - began:.0f} s: {arguments.out}\n"
    )


if __name__ == "__main__":
    main()
