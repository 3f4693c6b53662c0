"""What the page may ask for: the only things that are read of its requests."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from evaluation.talk.scenes import MOST_DRAWN, SceneName
from evaluation.talk.understanding import MOST_CHARACTERS

RobotNumber = Annotated[int, Field(ge=0, le=10**6)]
# Longer ones are refused with a message that says so.
Sentence = Annotated[str, Field(max_length=2 * MOST_CHARACTERS)]


class Question(BaseModel):
    """What the questions share."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class RobotQuestion(Question):
    """What a robot knows; `robot` is its place in the list of robots."""

    robot: RobotNumber


class SceneQuestion(RobotQuestion):
    """What there is to see in a scene."""

    number: int = Field(ge=1, le=MOST_DRAWN)
    drawn: bool

    @property
    def scene(self) -> SceneName:
        """Which scene."""
        return SceneName(self.number, self.drawn)


class HearQuestion(SceneQuestion):
    """What a robot, and perhaps another one, makes of a sentence in a scene."""

    sentence: Sentence
    other: RobotNumber | None = None


class ActQuestion(SceneQuestion):
    """What a robot does that is told a sentence in a scene."""

    sentence: Sentence
