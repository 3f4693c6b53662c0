"""What a robot makes of a sentence: the channel of each word, the object that is meant, and the action."""

from __future__ import annotations

import string
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evaluation.generation import objects_of
from evaluation.talk.robots import Robot, TalkError
from evaluation.uncertain.answers import object_probabilities
from features.table import FeatureTable
from model import Fit
from model.data import Floats
from model.heard import Heard
from model.log_space import log_sum
from model.prediction import LONGEST_INSTRUCTION, Answer, heard_as, understand

MOST_CHARACTERS = 1_000
"""A longer sentence is not read."""
NO_CHANNEL = "no channel"
"""What a word is of that the model has learned to be of none."""
MOST_FRAMED = 8
"""Of more known words the channels are not told: the sum over their frames would take seconds."""


@dataclass(frozen=True)
class Word:
    """A word of a sentence.

    Attributes:
        text: As the robot knows it, or as it was said.
        known: Whether the robot has heard it before; an unknown word is left out.
        channels: By channel the probability that it explains the word here, together at most 1; None where the
            method has no frames, the word is unknown, or there are more than `MOST_FRAMED`.
    """

    text: str
    known: bool
    channels: Mapping[str, float] | None


@dataclass(frozen=True, eq=False)
class Understanding:
    """What a robot makes of a sentence in a scene of M objects.

    Attributes:
        words: The sentence, word by word.
        answer: The distribution over objects and action categories.
        objects: (M,) the probability that each object is meant.
        categories: (K,) the probability of each action category.
        labels: (K,) the word that each action category utters most probably.
    """

    words: tuple[Word, ...]
    answer: Answer
    objects: Floats
    categories: Floats
    labels: tuple[str, ...]

    @property
    def sentence(self) -> str:
        """The words, parted by blanks."""
        return " ".join(word.text for word in self.words)

    @property
    def unknown(self) -> tuple[str, ...]:
        """The words that the robot has never heard."""
        return self.answer.ignored

    @property
    def chosen(self) -> tuple[int, ...]:
        """The most probable objects: one, or several that are tied."""
        return tuple(sorted({m for m, _ in self.answer.choices()}))


def words_of(sentence: str, vocabulary: Sequence[str], most: int = LONGEST_INSTRUCTION) -> tuple[str, ...]:
    """The words of a sentence, as a vocabulary has them where it does whatever their case and punctuation.

    Raises:
        TalkError: It is too long; the message says how long it may be.
    """
    if len(sentence) > MOST_CHARACTERS:
        raise TalkError(f"a sentence of {len(sentence):,} characters (at most {MOST_CHARACTERS:,} are allowed)")
    said = sentence.split()
    if len(said) > most:
        raise TalkError(f"a sentence of {len(said)} words (at most {most} are allowed)")
    known = {word.casefold(): word for word in reversed(vocabulary)}
    bare = [(word, word.strip(string.punctuation + "“”„’…")) for word in said]
    return tuple(
        word if word in vocabulary else known.get(stripped.casefold(), stripped)
        for word, stripped in bare
        if stripped
    )


def hear(robot: Robot, table: FeatureTable, row: int, sentence: str) -> Understanding:
    """Let a robot understand a sentence in a scene.

    Args:
        robot: Who hears it.
        table: The features of scenes, as the robot sees them.
        row: The scene's row in the table.
        sentence: Words parted by blanks; none included.

    Raises:
        TalkError: The sentence is too long.
        ValueError: There is no object on the table.
    """
    fit = robot.fit
    vocabulary = fit.trials.vocabulary
    said = words_of(sentence, vocabulary, fit.problem.frame_prior.longest_instruction)
    objects = objects_of(table, row)
    answer = understand(fit, objects, said)
    known = [word for word in said if word in vocabulary]
    framed = fit.problem.method.has_frames and len(known) <= MOST_FRAMED
    channels = iter(word_channels(fit, objects, known) if framed else ())
    words = tuple(
        Word(word, word in vocabulary, next(channels, None) if word in vocabulary else None) for word in said
    )
    # A category's word is what it utters most probably, which for one that hears nothing is a word like any other.
    uttered = np.argmax(fit.knowledge.categories.log_words[0], axis=1) if vocabulary else []
    return Understanding(
        words=words,
        answer=answer,
        objects=object_probabilities(answer),
        categories=np.asarray(answer.probabilities.sum(axis=0)),
        labels=tuple(vocabulary[int(w)] for w in uttered),
    )


def learned_channels(fit: Fit) -> dict[str, str | None]:
    """By word, in alphabetical order, the channel that explained it most often, or none; None without frames."""
    trials = fit.trials
    if not fit.problem.method.has_frames:
        return dict.fromkeys(sorted(trials.vocabulary))
    counts = np.zeros((len(trials.vocabulary), fit.problem.sources), dtype=np.int64)
    np.add.at(counts, (trials.words[0], fit.state.F), 1)
    names = [*(channel.name for channel in trials.channels), NO_CHANNEL]
    return dict(sorted(zip(trials.vocabulary, (names[int(c)] for c in counts.argmax(axis=1)), strict=True)))


def word_channels(fit: Fit, objects: Mapping[str, Floats], words: Sequence[str]) -> list[dict[str, float]]:
    """The posterior of the channel of each word of an instruction: p(F_n = x | words, objects), the frame summed out.

    A channel explains word n in a frame whose set S_x holds n. So the sum over these frames is the score of the
    instruction of which only these frames count.

    Args:
        fit: What was learned, by a method that has frames.
        objects: The features (M, dim) of the objects by channel.
        words: Known words.

    Returns:
        By word the probability of each channel; what they lack to 1 is that of no channel.
    """
    names = [channel.name for channel in fit.trials.channels]
    known = [fit.trials.vocabulary.index(word) for word in words]
    joint = np.full((len(fit.knowledge.states), len(known), len(names)), -np.inf)
    total = np.full(len(fit.knowledge.states), -np.inf)
    for i, state in enumerate(fit.knowledge.states):
        heard = heard_as(fit, state, objects, known)
        total[i] = _score(fit, heard)
        for n, c in np.ndindex(joint.shape[1:]):
            joint[i, n, c] = _score(fit, heard._replace(only=(n, c)))
    share = np.exp(log_sum(joint.transpose(1, 2, 0))[..., 0] - log_sum(total))
    return [dict(zip(names, row, strict=True)) for row in np.clip(share, 0.0, 1.0).tolist()]


def _score(fit: Fit, heard: Heard) -> float:
    """The log probability of an instruction, over all objects and action categories."""
    return float(log_sum(fit.problem.frame_prior.log_scores(heard).ravel())[0])
