"""The methods as data."""

from __future__ import annotations

from dataclasses import dataclass

from model.frames import Distinct, Every, FramePrior, Unlearned
from model.open_frames import AnyOrNone, Once


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
        # Sentences as people say them (docs/sentences.md).
        Method("proposed_open", "(A) with words of no channel", Once(none=True)),
        Method("no_mec2_open", "(B) with words of no channel", AnyOrNone()),
        Method("proposed_ordered", "(A) with word order", Once(ordered=True)),
        Method("proposed_open_ordered", "(A) with words of no channel and word order", Once(none=True, ordered=True)),
        # The paper's reference ALL.
        Method("gmm", "ALL", Every(), hears_words=False),
    )
}
