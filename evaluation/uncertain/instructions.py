"""Uncertain instructions: words are missing, wrong, unknown or too many, or two objects are alike.

All are made from the instructions of the test set and the features of their scenes, without chance. No scene is
simulated anew: the second of two alike objects has the very features of the first, at a place that an object of
another scene has, so that nothing but the place can tell them apart.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from evaluation.scores import Words
from evaluation.uncertain.scenes import OBJECT_CHANNELS, Scene, places_of, scene_of, with_twin
from features.table import FeatureTable


@dataclass(frozen=True, eq=False)
class Instruction:
    """What the robot is told, and which objects it can mean.

    Attributes:
        kind: Which of `KINDS` it is.
        scene: The objects on the table.
        words: The sentence.
        fits: For each object whether no word contradicts it; None where that is not known.
    """

    kind: str
    scene: Scene
    words: tuple[str, ...]
    fits: tuple[bool, ...] | None


@dataclass(frozen=True, eq=False)
class Source:
    """What uncertain instructions are made from: one instruction of the test set.

    Attributes:
        scene: Its scene.
        twin: The scene with the instructed object a second time; None where it cannot be made.
        said: The word of each channel, in the order in which they are said.
        words: The words of the experiment, by channel.
    """

    scene: Scene
    twin: Scene | None
    said: Mapping[str, str]
    words: Words

    @property
    def complete(self) -> bool:
        """Whether a word of each channel is said."""
        return len(self.said) == len(self.words)

    def others(self, channel: str) -> Iterator[str]:
        """The words of a channel but the one that is said."""
        return (word for word in self.words[channel] if word != self.said.get(channel))

    def without(self, channel: str) -> tuple[str, ...]:
        """The sentence without a channel's word."""
        return tuple(word for own, word in self.said.items() if own != channel)


Made = Iterator[tuple[Scene, tuple[str, ...]]]


def _kept(count: int) -> Callable[[Source], Made]:
    """Every choice of `count` words of the sentence."""
    return lambda source: ((source.scene, words) for words in combinations(source.said.values(), count))


def _no_fit(source: Source) -> Made:
    """A word of an object channel gives way to one of the same channel that is true of no object."""
    for channel in OBJECT_CHANNELS:
        true = source.scene.truth[channel]
        if channel in source.said and None not in true:
            for other in source.others(channel):
                if other not in true:
                    yield source.scene, tuple({**source.said, channel: other}.values())


def _unknown_word(source: Source) -> Made:
    """A word that nobody ever said is added."""
    word = "blorp"
    while any(word in own for own in source.words.values()):
        word += "-blorp"
    yield source.scene, (*source.said.values(), word)


def _five_words(source: Source) -> Made:
    """A second, other word of a channel is added."""
    if source.complete:
        for channel in source.said:
            for other in source.others(channel):
                yield source.scene, (*source.said.values(), other)


def _repeated_word(source: Source) -> Made:
    """A word is said a second time."""
    if source.complete:
        for word in source.said.values():
            yield source.scene, (*source.said.values(), word)


def _repeated_channel(source: Source) -> Made:
    """A second, other word of an object channel stands in the place of the action word."""
    if source.complete:
        for channel in OBJECT_CHANNELS:
            for other in source.others(channel):
                yield source.scene, (*source.without("action"), other)


def _two_alike(source: Source) -> Made:
    """There are two instructed objects, and the place is not said."""
    if source.twin is not None:
        yield source.twin, source.without("position")


def _two_alike_place(source: Source) -> Made:
    """There are two instructed objects, and the place tells which is meant."""
    if source.twin is not None and "position" in source.said:
        yield source.twin, tuple(source.said.values())


@dataclass(frozen=True)
class Kind:
    """A kind of uncertain instruction.

    Attributes:
        label: What tables and figures call it.
        make: Its scenes and sentences, from one instruction of the test set.
        wrong: Whether one word is not true of the instructed object or action, and can be outvoted.
    """

    label: str
    make: Callable[[Source], Made]
    wrong: bool = False


KINDS = {
    "words_0": Kind("no word", _kept(0)),
    "words_1": Kind("1 word", _kept(1)),
    "words_2": Kind("2 words", _kept(2)),
    "words_3": Kind("3 words", _kept(3)),
    "words_4": Kind("4 words", _kept(4)),
    "two_alike": Kind("two alike objects, place not said", _two_alike),
    "two_alike_place": Kind("two alike objects, place said", _two_alike_place),
    "unknown_word": Kind("an unknown word more", _unknown_word),
    "repeated_word": Kind("five words, one said twice", _repeated_word),
    "five_words": Kind("five words, one contradicts", _five_words, wrong=True),
    "repeated_channel": Kind("four words, one contradicts", _repeated_channel, wrong=True),
    "no_fit": Kind("a word that fits no object", _no_fit, wrong=True),
}


def instructions(table: FeatureTable, words: Words) -> tuple[Instruction, ...]:
    """Make the uncertain instructions of every kind, in the order of the table's trials and of `KINDS`.

    Args:
        table: The instructions of the test set, with the objects on the table. There are none of a kind that needs
            truth which the table does not hold.
        words: The words of the experiment, by channel. Of an instruction's words the first of each channel counts.
    """
    channel_of = {word: channel for channel, own in words.items() for word in own}
    made = []
    for source in _sources(table, words, channel_of):
        for name, kind in KINDS.items():
            for scene, sentence in kind.make(source):
                made.append(Instruction(name, scene, sentence, fitting(scene, sentence, channel_of)))
    return tuple(made)


def fitting(scene: Scene, sentence: Sequence[str], channel_of: Mapping[str, str]) -> tuple[bool, ...] | None:
    """Tell for each object whether it fits: its true words contradict no word of the sentence.

    Action words, and words of no channel, fit any object.

    Args:
        scene: The objects.
        sentence: The words.
        channel_of: The true channel of each word.

    Returns:
        (M,) flags; None where a true word that the sentence speaks of is not known.
    """
    said = [(scene.truth[channel_of[word]], word) for word in sentence if channel_of.get(word) in OBJECT_CHANNELS]
    if any(None in true for true, _ in said):
        return None
    M = len(scene.features["position"])
    return tuple(all(true[m] == word for true, word in said) for m in range(M))


def _sources(table: FeatureTable, words: Words, channel_of: Mapping[str, str]) -> Iterator[Source]:
    places = places_of(table, words)
    for row, sentence in enumerate(table.words):
        scene = scene_of(table, row)
        said: dict[str, str] = {}
        for word in sentence:
            if word in channel_of:
                said.setdefault(channel_of[word], word)
        yield Source(scene, with_twin(scene, places), said, words)
