"""What chance would give: levels beside the measures of the tasks, under the measure's name with `_chance`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd


def generation_chance(answered: pd.DataFrame, words: Mapping[str, Sequence[str]]) -> dict[str, float | None]:
    """Chance levels of OAR and WAR; None where the measure is not defined.

    OAR: an object chosen at random, so the mean of 1/M over the instructions whose object is known.
    WAR: an action that the tutor calls by each of the action words equally often, so 1 / number of action words,
    whatever the instructions ask for.

    Args:
        answered: what `generation.read_answers` gives.
        words: the words by channel.
    """
    objects = answered.loc[answered["object_right"].notna(), "objects"]
    executed = len(answered.dropna(subset=["action", "judged"])) > 0
    return {
        "OAR_chance": float((1 / objects).mean()) if len(objects) else None,
        "WAR_chance": 1 / len(words["action"]) if executed else None,
    }


def description_chance(channels: Sequence[str], words: Mapping[str, Sequence[str]]) -> dict[str, float | None]:
    """Chance level of ACC: a word of the right channel at random; None without words.

    That is the mean of 1 / number of words of the channel over the words to say. It is higher than that of a word
    at random from the whole vocabulary, because which channel a place of the sentence belongs to is given.

    Args:
        channels: the channel of each word to say.
        words: the words by channel.
    """
    levels = [1 / len(words[channel]) for channel in channels]
    return {"ACC_chance": float(np.mean(levels)) if levels else None}
