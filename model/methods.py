"""The methods as data."""

from __future__ import annotations

from dataclasses import dataclass

from model.frames import Distinct, Every, FramePrior


@dataclass(frozen=True)
class Method:
    """One of the compared methods (section 4.1 of the paper).

    Attributes:
        name: Its name in configs and files.
        label: What tables call it.
        frame_prior: Which channels may explain which words.
        hears_words: Whether it is given the words; without any, all methods are the same mixtures.
    """

    name: str
    label: str
    frame_prior: FramePrior
    hears_words: bool = True

    @property
    def has_frames(self) -> bool:
        """Whether the words have an estimated channel, and so an EAR."""
        return self.frame_prior.has_frames


METHODS: dict[str, Method] = {
    method.name: method
    for method in (
        Method("proposed", "(A) proposed", Distinct()),
        Method("no_mec2", "(B) w/o MEC-II", FramePrior()),
        Method("mmlda", "(C) mMLDA", Every()),
        # The paper's reference ALL.
        Method("gmm", "ALL", Every(), hears_words=False),
    )
}
