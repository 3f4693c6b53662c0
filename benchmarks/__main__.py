"""Run the benchmarks: `python -m benchmarks --out DIR [--quick]`.

Writes fits.csv (time and memory of fits), kernels.csv (hot kernels against the peak of one core), scaling.png,
roofline.png, and summary.md, which sums them up. The progress goes to standard error.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from pathlib import Path

# Before NumPy is imported: one thread, as for every fit.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"


def main() -> None:
    """Measure, write, draw."""
    import pandas as pd

    from benchmarks.cases import all_cases
    from benchmarks.kernels import measure_kernels, measure_machine
    from benchmarks.measure import as_row, measure
    from benchmarks.plots import draw_roofline, draw_scaling
    from benchmarks.summary import summary

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
    kernels = pd.DataFrame(
        {
            "kernel": kernel.name,
            "dimension": kernel.dimension,
            "flops": kernel.flops,
            "bytes": kernel.bytes,
            "seconds": kernel.seconds,
            "gigaflops": kernel.flops / kernel.seconds / 1e9,
            "share_of_peak": kernel.flops / kernel.seconds / machine.peak,
            "share_of_roof": kernel.flops
            / kernel.seconds
            / min(machine.peak, machine.bandwidth * kernel.flops / kernel.bytes),
        }
        for kernel in measure_kernels(arguments.quick)
    )
    kernels.to_csv(arguments.out / "kernels.csv", index=False, float_format="%.6g")
    draw_roofline(kernels, machine, arguments.out / "roofline.png")
    (arguments.out / "summary.md").write_text(summary(fits, kernels, machine), encoding="utf-8")
    sys.stderr.write(
        f"one core: {machine.peak / 1e9:.1f} · 10⁹ operations and {machine.bandwidth / 1e9:.1f} GB per second; "
        f"done in {time.perf_counter() - began:.0f} s: {arguments.out}\n"
    )


if __name__ == "__main__":
    main()
