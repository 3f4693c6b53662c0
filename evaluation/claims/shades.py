"""Whether shades of a color are categories of their own: what the claim about the paper's Figure 8 rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from evaluation.claims.terms import FIGURE_8
from features.table import FeatureTable
from model import Fit


class Shade(NamedTuple):
    """The color category that most objects of a shade are in.

    Attributes:
        word: The word of the color.
        shade: Which of its shades, from 0.
        objects: How many objects of the trials have it.
        category: The category, from 1 as in figures; of equal ones the first.
        of_shade: Share of the objects of the shade that are in it, 0 to 1.
        of_category: Share of the objects in it that are of the shade.
        says: The word that it most probably utters.
    """

    word: str
    shade: int
    objects: int
    category: int
    of_shade: float
    of_category: float
    says: str


def shades_of(fit: Fit, table: FeatureTable, shades: Mapping[tuple[str, str], int], word: str) -> list[Shade]:
    """Find the category of each shade of a color in the last state of a fit.

    Args:
        fit: The fit, of a method that hears words.
        table: What it was fitted to, with the truth of objects.
        shades: The shade of the objects with a word of object and of color, where all such have the same.
        word: The word of the color.

    Returns:
        The shades that occur, in their order.
    """
    c = fit.trials.index_of("color")
    z, spoken = fit.state.z[c], np.asarray(fit.state.log_words[c])
    told = zip(table.truth_object or (), table.truth_color or (), strict=True)
    known = np.array([shades.get((str(what), word), -1) if color == word else -1 for what, color in told])
    found = []
    for shade in np.unique(known[known >= 0]):
        own = z[known == shade]
        k = int(np.bincount(own).argmax())
        shared = int(np.sum(own == k))
        says = fit.trials.vocabulary[int(spoken[k].argmax())]
        of_category = shared / int(np.sum(z == k))
        found.append(Shade(word, int(shade), len(own), k + 1, shared / len(own), of_category, says))
    return found


def apart(found: Sequence[Shade]) -> float | None:
    """Return 1 where the shades are categories of their own that say their word, else 0; None of a single shade.

    A shade is a category of its own if most of its objects are in one, and most objects in this one are of the shade.
    """
    if len(found) < 2:
        return None
    return float(all(one.of_shade > 0.5 and one.of_category > 0.5 and one.says == one.word for one in found))


def is_figure_8(condition: Mapping[str, object]) -> bool:
    """Return whether a condition is the one that the paper's Figure 8 shows a fit of."""
    return all(condition[key] == value for key, value in vars(FIGURE_8).items() if key != "measure")
