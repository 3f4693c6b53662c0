"""What was measured, as a page of a few tables."""

from __future__ import annotations

import platform
import re
from collections.abc import Hashable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from benchmarks.kernels import Machine
from benchmarks.plots import LABELS
from model import METHODS

_PAGE = """# Benchmarks

Written by `python -m benchmarks`. {processor}, one core: {peak:.0f} · 10⁹ floating-point operations and
{bandwidth:.0f} GB per second. Seconds are processor time, without imports and compilation; memory is the most that
the process held.

## A fit at the paper's sizes

D = {D}, dimensions {dimensions}, K = {K}, {iterations} iterations; the fastest of {repetitions}.

{paper}
{large}

## Growth

p is the exponent of t ∝ sizeᵖ between the two largest sizes; 1 is linear. Method (A) weighs all C!/(C−N)! frames of
N words over C channels, here with N up to 4.

{growth}
![Growth](scaling.png)

## Hot kernels

Share of one core's peak in per cent, by the dimension of the features; 80 elements, 10 categories.

{kernels}
![Roofline](roofline.png)
"""


def summary(fits: pd.DataFrame, kernels: pd.DataFrame, machine: Machine) -> str:
    """The tables of a run as Markdown.

    Args:
        fits: Rows of `measure.as_row`.
        kernels: The rows of kernels.csv.
        machine: What one core reaches.
    """
    paper = fits[fits.series == "paper"].to_dict("records")
    large = fits[fits.series == "large"].to_dict("records")[0]
    first = paper[0]
    return _PAGE.format(
        processor=processor(),
        peak=machine.peak / 1e9,
        bandwidth=machine.bandwidth / 1e9,
        D=first["trials"],
        dimensions=str(first["dimensions"]).replace(" ", " / "),
        K=first["categories"],
        iterations=first["iterations"],
        repetitions=first["repetitions"],
        paper=markdown(["sampler", "method", "seconds", "MiB", "MiB before the fit"], map(paper_row, paper)),
        large=f"D = {large['trials']:,}, {large['iterations']} iterations, {large['sampler']}: "
        f"{large['processor_seconds']:.1f} s, {large['peak_mebibytes']:.0f} MiB.",
        growth=markdown(["size", "sampler", "sizes", "milliseconds per iteration", "p"], growth_rows(fits)),
        kernels=markdown(["kernel", *map(str, sorted(set(kernels.dimension)))], kernel_rows(kernels)),
    )


def paper_row(row: Mapping[Hashable, Any]) -> list[str]:
    """Sampler, method, seconds and memory of a fit."""
    memory = [f"{row[name]:.0f}" for name in ("peak_mebibytes", "baseline_mebibytes")]
    return [row["sampler"], METHODS[row["method"]].label, f"{row['processor_seconds']:.2f}", *memory]


def growth_rows(fits: pd.DataFrame) -> Iterable[list[str]]:
    """For each series and sampler the times, and how they grow at its end."""
    for series, label in LABELS.items():
        for sampler, rows in fits[fits.series == series].groupby("sampler"):
            times = 1000.0 * rows.processor_seconds_per_iteration
            yield [
                label,
                str(sampler),
                ", ".join(f"{size:,}" for size in rows["size"]),
                ", ".join(f"{t:.3g}" for t in times),
                f"{exponent(list(rows['size']), list(times)):.2f}",
            ]


def exponent(sizes: Sequence[float], times: Sequence[float]) -> float:
    """The p of t ∝ sizeᵖ through the last two points."""
    return float(np.log(times[-1] / times[-2]) / np.log(sizes[-1] / sizes[-2]))


def kernel_rows(kernels: pd.DataFrame) -> Iterable[list[str]]:
    """For each kernel its share of the peak at each dimension, in per cent."""
    for name, rows in kernels.groupby("kernel", sort=False):
        yield [str(name), *(f"{100 * share:.0f}" for share in rows.sort_values("dimension").share_of_peak)]


def markdown(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def processor() -> str:
    """Name of the processor."""
    path = Path("/proc/cpuinfo")
    found = re.findall(r"model name\s*: (.*)", path.read_text(encoding="utf-8")) if path.is_file() else []
    return str(found[0]) if found else platform.machine()
