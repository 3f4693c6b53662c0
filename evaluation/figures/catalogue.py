"""The figures of a study, as data. Imports nothing heavy, because the rules read it too."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """One kind of figure; an experiment has it where the study has its inputs, as `figures/{experiment}_{name}`.

    Attributes:
        draw: The function that draws it, `module:function` of `evaluation.figures`; it is given a
            `evaluation.figures.source.Source`.
        inputs: What it is drawn from: a key of `FIGURE_INPUTS` in `workflow/rules/presentation_functions.smk`.
        caption: What is seen, in one to three sentences.
        paper: What the paper calls it, in Experiments I and II; None for a figure that the paper does not have.
        first: Whether the report shows it at once; others are folded.
        forms: The endings of its files; pages show the first.
    """

    draw: str
    inputs: str
    caption: str
    paper: str | None = None
    first: bool = False
    forms: tuple[str, ...] = ("png", "pdf")

    @property
    def module(self) -> str:
        """The file of the function that draws it, from the root of the project."""
        return f"evaluation/figures/{self.draw.partition(':')[0]}.py"

    @property
    def full_caption(self) -> str:
        """The caption, and what the paper calls the figure."""
        return f"{self.caption} In the paper: {self.paper}." if self.paper else self.caption


def _crops(channel: str, part: str) -> Figure:
    """The crops in the categories of a channel; `part` of the paper's figures."""
    caption = (
        f"What the robot saw of the objects in each {channel} category of the same fit, the most typical first. Each "
        "category is named by its most probable word; categories without an object are left out."
    )
    return Figure(f"categories:{channel}_categories", "fit and crops", caption, f"Figures 4{part} and 8{part}")


def _curves(function: str, over: str, axis: str) -> Figure:
    """Every measure over a setting, which `axis` tells in words."""
    caption = (
        f"Every measure over {axis}, with 95 % bootstrap intervals over data sets and seeds, by method and, from "
        "left to right, by sampler. ALL hears no words."
    )
    return Figure(f"curves:{function}", f"scores over {over}", caption, first=True)


# By name. A name with {method} stands for a figure per method, one with {sampler} for a figure of each sampler that
# the config shows; where it shows one alone, {sampler} is empty.
FIGURES = {
    "words{sampler}": Figure(
        "fit:words",
        "fit",
        "The word distributions θ of the most probable fit: a row for each category in use, a column for each "
        "word, darker where the word is more probable. A box surrounds each channel's own words; where words are "
        "learned well, the dark cells lie in the boxes.",
        "Figures 4A and 8A",
        first=True,
    ),
    "positions{sampler}": Figure(
        "fit:positions",
        "fit",
        "The position categories of the same fit, seen from above: crosses are the objects, ellipses the categories "
        "at two standard deviations. Each is named by its most probable word.",
        "Figures 4B and 8B",
    ),
    "object_categories{sampler}": _crops("object", "C"),
    "color_categories{sampler}": _crops("color", "D"),
    "omission_curves": _curves(
        "over_omission", "ROW", "the share of the words that were left out, for the largest and the smallest D"
    ),
    "learning_curves": _curves(
        "over_trials", "D", "the number of trials, for the smallest and the largest share of words left out"
    ),
    "confusion_{method}": Figure(
        "confusion:confusion",
        "descriptions",
        "What the robot said (columns) of what the tutor called (rows): counts over all seeds and test actions, the "
        "shade is the share of the row. Lines part the channels.",
        "Figures 6 and 10, of method A",
    ),
    "generation": Figure(
        "generation:generation",
        "executed answers",
        "What the robot did when it was told to: the instruction, the scene before and after, and the tutor's word "
        "for what happened. The fit is the one with the highest log joint of all seeds.",
        "Figures 5 and 9",
    ),
    "action": Figure(
        "generation:action",
        "executed answers",
        "One of these actions in motion: the first that was carried out rightly and in which the hand moved; where "
        "there is none, the first.",
        "Figures 5 and 9",
        forms=("gif",),
    ),
    "instructions": Figure(
        "instructions:instructions",
        "instructions",
        "How the most probable fit understands each instruction of the test set: the probability of every object and "
        "action category.",
    ),
    "uncertain": Figure(
        "uncertain:uncertain",
        "uncertain answers",
        "What the fits make of instructions in which words are missing, wrong, unknown or too many, and of two "
        "objects that are alike.",
    ),
    "features": Figure(
        "features:features",
        "features",
        "What the robot sees and feels: detected objects, their crops and colors, the actions' numbers, and how far "
        "these features tell the words apart.",
        forms=("png",),
    ),
    "trials": Figure(
        "simulated:trials",
        "simulated trials",
        "The first training trials: the scene before and after the action, with the tutor's sentence and, in "
        "brackets, what happened.",
        forms=("png",),
    ),
    "objects": Figure("simulated:objects", "simulation", "The objects of the experiment, on the table.", "Figure 7"),
}


@dataclass(frozen=True)
class ShownFigure:
    """A figure of a study, as pages show it.

    Attributes:
        path: Its file, below the output folder.
        title: Its heading.
        caption: What is seen.
        first: Whether the report shows it at once.
    """

    path: str
    title: str
    caption: str
    first: bool = False


def shown_figure(name: str, experiment: str, method: str = "", sampler: str = "") -> ShownFigure:
    """A figure of an experiment and, where it is drawn for each, of a method or a sampler (as `_mixing`)."""
    figure, own = FIGURES[name], name.format(method=method, sampler=sampler)
    title = f"{own.replace('_', ' ').capitalize()}, {experiment}"
    return ShownFigure(f"figures/{experiment}_{own}.{figure.forms[0]}", title, figure.full_caption, figure.first)
