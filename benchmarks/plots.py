"""Draw what was measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from benchmarks.kernels import Machine

LABELS = {
    "D": "trials D",
    "K": "categories K",
    "dimension": "dimension of the object feature",
    "W": "words W",
    "channels": "channels",
}


def draw_scaling(fits: pd.DataFrame, path: Path) -> None:
    """Processor time of an iteration along each series, both axes logarithmic; the grey line grows linearly."""
    figure = Figure(figsize=(3.2 * len(LABELS), 3.2), layout="constrained")
    axes = figure.subplots(1, len(LABELS))
    for axis, (series, label) in zip(axes, LABELS.items(), strict=True):
        for inference, rows in fits[fits.series == series].groupby("inference"):
            axis.loglog(rows["size"], rows.processor_seconds_per_iteration, "o-", label=inference)
            first = rows.iloc[0]
            axis.loglog(
                rows["size"],
                rows["size"] / first["size"] * first.processor_seconds_per_iteration,
                color="0.8",
                zorder=0,
            )
        axis.set_xlabel(label)
    axes[0].set_ylabel("seconds an iteration")
    axes[0].legend()
    figure.savefig(path, dpi=120)


def draw_roofline(kernels: pd.DataFrame, machine: Machine, path: Path) -> None:
    """Speed of the kernels over their arithmetic intensity, under the roof of one core."""
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axis = figure.subplots()
    intensity = np.geomspace(0.05, 100, 50)
    axis.loglog(intensity, np.minimum(machine.peak, intensity * machine.bandwidth) / 1e9, "k-", label="one core")
    for name, rows in kernels.groupby("kernel"):
        axis.loglog(rows.flops / rows.bytes, rows.gigaflops, "o", label=name)
        for _, row in rows.iterrows():
            axis.annotate(str(row.dimension), (row.flops / row.bytes, row.gigaflops), fontsize=7)
    axis.set_xlabel("floating-point operations a byte (numbers: dimension)")
    axis.set_ylabel("10⁹ floating-point operations a second")
    axis.legend(fontsize=8)
    figure.savefig(path, dpi=120)
