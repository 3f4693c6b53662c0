"""What a sampler is to solve: trials, a method, and the hyperparameters of all channels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from model.data import Flags, Ints, Trials
from model.frame_paths import Paths
from model.frames import FramePrior
from model.methods import METHODS, Method
from model.prior import LEARNED, GaussianPrior, Prior


@dataclass(frozen=True)
class Problem:
    """Trials to be explained by a method.

    Attributes:
        trials: The data.
        method: The method, which says what frames sentences have.
        priors: Hyperparameters, one per channel.
        learned: κ0 of each channel as a chain has learned it so far; None at its start. Where the prior says what κ0
            is, it has no effect.

    Raises:
        ValueError: The number of priors is not that of the channels, or a sentence has no frame.
    """

    trials: Trials
    method: Method
    priors: tuple[Prior, ...]
    learned: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if len(self.priors) != len(self.trials.channels):
            raise ValueError(f"{len(self.priors)} priors for {len(self.trials.channels)} channels")
        limit = self.frame_prior.word_limit(len(self.priors))
        long = np.flatnonzero(self.trials.sentence_lengths > limit)
        if len(long):
            raise ValueError(
                f"{len(long)} sentences have more than {limit} words (rows {', '.join(map(str, long[:5]))} of the "
                f"trials), the longest that method {self.method.name} explains: shorten them or use proposed_open, "
                "no_mec2 or mmlda"
            )

    @classmethod
    def of(cls, trials: Trials, method: str, priors: Prior | Sequence[Prior] = Prior()) -> Problem:  # noqa: B008
        """Build a problem with the name of a method, and one prior for all channels or one for each.

        Raises:
            ValueError: There is no such method, or as for the class.
        """
        if method not in METHODS:
            raise ValueError(f"method {method!r} is unknown (there are {', '.join(METHODS)})")
        shared = (priors,) * len(trials.channels) if isinstance(priors, Prior) else tuple(priors)
        return cls(trials, METHODS[method], shared)

    @property
    def frame_prior(self) -> FramePrior:
        """The prior of the frames."""
        return self.method.frame_prior

    @property
    def sources(self) -> int:
        """Where words may come from: the channels, and behind them ∅ where the method has it."""
        return self.frame_prior.sources(len(self.priors))

    @property
    def none_concentration(self) -> float:
        """γ of the words of no channel: that of the first channel."""
        return self.priors[0].word_concentration

    @property
    def paths(self) -> Paths | None:
        """The states of the trials' frames, None for a method whose frames are listed."""
        return self.frame_prior.paths(len(self.priors), max(1, self.trials.longest_sentence))

    @property
    def learns(self) -> bool:
        """Whether κ0 of any channel is learned."""
        return any(prior.mean_precision == LEARNED for prior in self.priors)

    @cached_property
    def mean_precision(self) -> tuple[float, ...]:
        """κ0 of each channel; where it is learned, the middle of its values at the start of a chain."""
        known = self.learned or (None,) * len(self.priors)
        own = [prior.mean_precisions for prior in self.priors]
        return tuple(
            values[len(values) // 2] if len(values) == 1 or value is None else value
            for values, value in zip(own, known, strict=True)
        )

    @cached_property
    def gaussians(self) -> tuple[GaussianPrior, ...]:
        """The priors of the Gaussians, one per channel, given κ0."""
        triples = zip(self.trials.channels, self.priors, self.mean_precision, strict=True)
        return tuple(prior.gaussian(channel.dim, kappa) for channel, prior, kappa in triples)

    @property
    def log_hyperprior(self) -> float:
        """Log p(κ0) of all channels."""
        return -sum(math.log(len(prior.mean_precisions)) for prior in self.priors)

    def given(self, mean_precision: Iterable[float]) -> Problem:
        """The problem with κ0 of the channels that learn it at other values (C,)."""
        return replace(self, learned=tuple(map(float, mean_precision)))

    def is_like(self, other: Problem) -> bool:
        """Whether another problem is this one but for what has been learned of κ0."""
        return self.trials is other.trials and self.priors is other.priors and self.method is other.method

    def explained(self, F: Ints, c: int) -> Flags:
        """(T,) whether channel c explains each word."""
        return self.frame_prior.explained(self.trials, F, c)

    def counted(self, F: Ints, c: int) -> Flags:
        """(T,) whether each word counts for the word distributions of channel c."""
        return self.frame_prior.counted(self.trials, F, c)
