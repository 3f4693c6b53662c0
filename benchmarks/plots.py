"""Draw what was measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from benchmarks.kernels import Machine
from evaluation.convergence import GOAL

LABELS = {
    "D": "trials D",
    "K": "categories K",
    "dimension": "dimension of the object feature",
    "W": "words W",
    "channels": "channels",
}


def draw_scaling(fits: pd.DataFrame, path: Path) -> None:
    """Processor time per iteration along each series, both axes logarithmic; the grey line grows linearly."""
    figure = Figure(figsize=(2.9 * len(LABELS), 3.4), layout="constrained")
    axes = figure.subplots(1, len(LABELS), sharey=True)
    for axis, (series, label) in zip(axes, LABELS.items(), strict=True):
        of_series = fits[fits.series == series]
        for sampler, rows in of_series.groupby("sampler"):
            times = 1000.0 * rows.processor_seconds_per_iteration
            axis.loglog(rows["size"], times, "o-", label=sampler)
            linear = rows["size"] / rows["size"].iloc[0] * times.iloc[0]
            axis.loglog(
                rows["size"], linear, color="0.8", zorder=0, label="linear" if sampler == "published" else None
            )
        sizes = sorted(set(of_series["size"]))
        axis.set_xticks(sizes, [f"{size:,}" for size in sizes])
        axis.set_xticks([], minor=True)
        axis.set_xlabel(label)
    axes[0].yaxis.set_major_formatter("{x:g}")
    axes[0].set_ylabel("milliseconds per iteration")
    axes[0].legend(frameon=False)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def draw_convergence(rows: pd.DataFrame, path: Path) -> None:
    """The log joint with its lowest fit, and R-hat, against processor seconds; a column per data set."""
    sets = list(dict.fromkeys(rows.D))
    figure = Figure(figsize=(5.2 * len(sets), 5.6), layout="constrained")
    axes = figure.subplots(2, len(sets), sharex="col", squeeze=False)
    for (above, below), D in zip(axes.T, sets, strict=True):
        for sampler, own in rows[rows.D == D].groupby("sampler", sort=False):
            (line,) = above.plot(own.seconds, own.log_joint, "o-", markersize=3, label=sampler)
            above.fill_between(own.seconds, own.lowest, own.log_joint, color=line.get_color(), alpha=0.2, linewidth=0)
            below.plot(own.seconds, own.r_hat, "o-", markersize=3, color=line.get_color())
        below.axhline(GOAL, color="0.6", linewidth=0.8)
        above.set_title(f"D = {D}")
        above.set_xscale("log")
        below.set_yscale("log")
        ticks = [1, GOAL, 1.2, 1.5, 2, 3, 5]
        below.set_yticks(ticks, [f"{tick:g}" for tick in ticks])
        below.set_yticks([], minor=True)
        below.set_xlabel("processor seconds of a fit")
        below.xaxis.set_major_locator(LogLocator(subs=(1, 3)))
        below.xaxis.set_minor_formatter(NullFormatter())
        below.xaxis.set_major_formatter("{x:g}")
    axes[0, 0].set_ylabel("log joint, mean and lowest fit")
    axes[1, 0].set_ylabel("R-hat of the log joint")
    axes[0, 0].legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=110, metadata={"Software": None})


def draw_roofline(kernels: pd.DataFrame, machine: Machine, path: Path) -> None:
    """Speed of the kernels over their arithmetic intensity, under the roof of one core."""
    figure = Figure(figsize=(7.2, 4.6), layout="constrained")
    axis = figure.subplots()
    ridge = machine.peak / machine.bandwidth
    intensity = np.array([0.05, ridge, 400.0])
    roof = f"one core: {machine.peak / 1e9:.0f} · 10⁹ operations, {machine.bandwidth / 1e9:.0f} GB per second"
    axis.loglog(intensity, np.minimum(machine.peak, intensity * machine.bandwidth) / 1e9, "k-", label=roof)
    for name, rows in kernels.groupby("kernel"):
        (line,) = axis.loglog(rows.flops / rows.bytes, rows.gigaflops, "o-", linewidth=0.5, markersize=4, label=name)
        for _, row in rows.iterrows():
            place = (row.flops / row.bytes, row.gigaflops)
            axis.annotate(
                str(row.dimension), place, (4, -3), textcoords="offset points", fontsize=6, color=line.get_color()
            )
    axis.yaxis.set_major_formatter("{x:g}")
    axis.xaxis.set_major_formatter("{x:g}")
    axis.set_xlabel("floating-point operations per byte (numbers: dimension)")
    axis.set_ylabel("10⁹ floating-point operations per second")
    axis.legend(fontsize=7, loc="lower right")
    figure.savefig(path, dpi=110, metadata={"Software": None})
