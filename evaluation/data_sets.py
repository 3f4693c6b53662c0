"""The data sets of an experiment by name, and where fits are. Imports nothing heavy, as the plan reads it too."""

from __future__ import annotations

from dataclasses import dataclass

FIT_PATH = "fits/{experiment}/{variant}/{method}/{sampler}/D{D}/ROW{ROW}/seed{seed}.npz"
"""Where a fit is, below the output folder; `experiment` is the name of a data set."""


@dataclass(frozen=True)
class FitName:
    """The names of one fit; `experiment` is the name of a data set."""

    experiment: str
    variant: str
    method: str
    sampler: str
    D: int
    ROW: int
    seed: int

    @property
    def wildcards(self) -> dict[str, object]:
        """The names as paths have them."""
        return dict(vars(self))

    @property
    def path(self) -> str:
        """Where the fit is, below the output folder."""
        return FIT_PATH.format(**self.wildcards)


def data_set_name(experiment: str, dataset: int) -> str:
    """What files and draws call a data set of an experiment: the first has the experiment's own name.

    So the first is the same whether there are more or not. No name of a config has a dot.

    Args:
        experiment: The experiment's name in the config.
        dataset: The number of the data set, from 1.
    """
    return experiment if dataset == 1 else f"{experiment}.set{dataset}"
