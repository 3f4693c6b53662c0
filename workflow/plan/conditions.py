"""Conditions: the names of a fit, and where it and further chains of its posterior are."""

from __future__ import annotations

from dataclasses import dataclass

from evaluation.data_sets import FIT_PATH, FitName, data_set_name

CHAIN_PATH = FIT_PATH.removesuffix(".npz") + "_chain{chain}.npz"


@dataclass(frozen=True)
class Condition(FitName):
    """The names of one fit; `experiment` is that of the config, `dataset` the number of the data set, from 1."""

    dataset: int = 1

    @property
    def wildcards(self) -> dict[str, object]:
        """The names as paths have them, with the data set in place of the experiment."""
        return {**vars(self), "experiment": data_set_name(self.experiment, self.dataset)}

    def chain_path(self, chain: int) -> str:
        """Where another chain of the same posterior is; chain 1 is the fit itself."""
        return self.path if chain == 1 else CHAIN_PATH.format(**self.wildcards, chain=chain)
