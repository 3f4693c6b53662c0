"""How the chains of a condition went: traces of the log joint, and rank plots of label-free quantities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from evaluation.figures.drawing import page
from model import Fit
from model.data import Floats
from model.diagnostics import rank_counts

BINS = 10
COLUMNS = 5


def chains_figure(fits: Sequence[Fit], quantities: Mapping[str, Floats], title: str) -> Figure:
    """Draw the chains of a condition.

    Args:
        fits: One per chain.
        quantities: (chains, draws) of each quantity to rank; chains that agree have flat rank plots.
        title: The condition.
    """
    rows = -(-(len(quantities) + 1) // COLUMNS)
    with page(2.6 * rows, width=2.8 * COLUMNS) as figure:
        axes: Any = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for spare in axes[len(quantities) + 1 :]:
            spare.set_axis_off()
        figure.suptitle(title)
        for fit in fits:
            axes[0].plot(np.arange(1, len(fit.trace_log_joint) + 1), fit.trace_log_joint, linewidth=0.8)
        # The first iterations are far below the rest, and would leave it no room.
        late = np.concatenate([fit.trace_log_joint[len(fit.trace_log_joint) // 10 :] for fit in fits])
        axes[0].set_ylim(late.min(), late.max() + 0.05 * np.ptp(late) + 1e-9)
        axes[0].set_xlabel("iteration")
        axes[0].set_title("log p(X, w, z, F)")
        for panel, (name, draws) in zip(axes[1:], quantities.items(), strict=False):
            panel.imshow(rank_counts(draws, BINS), aspect="auto", cmap="Blues", vmin=0)
            panel.set_title(f"ranks of {name}")
            panel.set_xlabel("rank among all draws")
            panel.set_xticks([])
            panel.set_ylabel("chain")
            panel.set_yticks(range(len(draws)), [str(i + 1) for i in range(len(draws))], fontsize=6)
    return figure
