"""The methods as data."""

from __future__ import annotations

from dataclasses import dataclass

from model.frames import Distinct, Every, FramePrior, Unlearned


@dataclass(frozen=True)
class Method:
    """One of the compared methods (section 4.1 of the paper).

    Attributes:
        name: Its name in configs and files.
        label: What tables call it.
        frame_prior: Which channels may explain which words.
        hears_words: Whether it is given the words; without any, all methods are the same mixtures.
        is_model: Whether it is a generative model, whose posterior samplers draw from.
    """

    name: str
    label: str
    frame_prior: FramePrior
    hears_words: bool = True
    is_model: bool = True

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
        # What the authors' program computes for mMLDA.
        Method("mmlda_released", "(C) as released", Unlearned(), is_model=False),
        # The paper's reference ALL.
        Method("gmm", "ALL", Every(), hears_words=False),
    )
}
