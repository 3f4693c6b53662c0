"""What a sampler is to solve: trials, a method, and the hyperparameters of all channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from model.data import Flags, Ints, Trials
from model.frames import FramePrior
from model.methods import METHODS, Method
from model.prior import GaussianPrior, Prior


@dataclass(frozen=True)
class Problem:
    """Trials to be explained by a method.

    Attributes:
        trials: The data.
        method: The method, which says what frames sentences have.
        priors: Hyperparameters, one per channel.

    Raises:
        ValueError: The number of priors is not that of the channels, or a sentence has no frame.
    """

    trials: Trials
    method: Method
    priors: tuple[Prior, ...]

    def __post_init__(self) -> None:
        if len(self.priors) != len(self.trials.channels):
            raise ValueError(f"{len(self.priors)} priors for {len(self.trials.channels)} channels")
        limit = self.frame_prior.word_limit(len(self.priors))
        long = np.flatnonzero(self.trials.sentence_lengths > limit)
        if len(long):
            raise ValueError(
                f"{len(long)} sentences have more than {limit} words (rows {', '.join(map(str, long[:5]))} of the "
                f"trials), the longest that method {self.method.name} explains: shorten them or use no_mec2 or mmlda"
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

    @cached_property
    def gaussians(self) -> tuple[GaussianPrior, ...]:
        """The priors of the Gaussians, one per channel."""
        pairs = zip(self.trials.channels, self.priors, strict=True)
        return tuple(prior.gaussian(channel.dim) for channel, prior in pairs)

    def explained(self, F: Ints, c: int) -> Flags:
        """(T,) whether channel c explains each word."""
        return self.frame_prior.explained(self.trials, F, c)
