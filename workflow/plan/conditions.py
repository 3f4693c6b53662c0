"""Conditions: the names of a fit, and where it and further chains of its posterior are."""

from __future__ import annotations

from dataclasses import dataclass

from evaluation.data_sets import FIT_PATH, data_set_name

CHAIN_PATH = FIT_PATH.removesuffix(".npz") + "_chain{chain}.npz"


@dataclass(frozen=True)
class Condition:
    """The names of one fit; `dataset` is the number of the data set, from 1."""

    experiment: str
    variant: str
    method: str
    sampler: str
    D: int
    ROW: int
    seed: int
    dataset: int = 1

    @property
    def data_set(self) -> str:
        """What files and draws call the data set, see `data_set_name`."""
        return data_set_name(self.experiment, self.dataset)

    @property
    def wildcards(self) -> dict[str, object]:
        """The names as paths have them."""
        return {**vars(self), "experiment": self.data_set}

    @property
    def path(self) -> str:
        """Where the fit is, below the output folder."""
        return FIT_PATH.format(**self.wildcards)

    def chain_path(self, chain: int) -> str:
        """Where another chain of the same posterior is; chain 1 is the fit itself."""
        return self.path if chain == 1 else CHAIN_PATH.format(**self.wildcards, chain=chain)

    @property
    def seeds_share_words(self) -> bool:
        """Whether every seed hears the same words, all or none, so that seeds are chains of one posterior."""
        return self.ROW in (0, 100)
