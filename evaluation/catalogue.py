"""What a study renders, as data: its tables and figures. Imports nothing heavy, because the rules read it too."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

TABLE_FORMS = ("csv", "md", "tex", "html")


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


_CURVES = (
    "with 95 % bootstrap intervals over data sets and seeds, by method and, from left to right, by sampler. ALL "
    "hears no words."
)
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
    "object_categories{sampler}": Figure(
        "categories:object_categories",
        "fit and crops",
        "What the robot saw of the objects in each object category of the same fit, the most typical first. Each "
        "category is named by its most probable word; categories without an object are left out.",
        "Figures 4C and 8C",
    ),
    "color_categories{sampler}": Figure(
        "categories:color_categories",
        "fit and crops",
        "What the robot saw of the objects in each color category of the same fit, the most typical first. Each "
        "category is named by its most probable word; categories without an object are left out.",
        "Figures 4D and 8D",
    ),
    "omission_curves": Figure(
        "curves:over_omission",
        "scores over ROW",
        "Every measure over the share of the words that were left out, for the largest and the smallest D, "
        + _CURVES,
        first=True,
    ),
    "learning_curves": Figure(
        "curves:over_trials",
        "scores over D",
        "Every measure over the number of trials, for the smallest and the largest share of words left out, "
        + _CURVES,
        first=True,
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


@dataclass(frozen=True)
class TaskTables:
    """What the tables of a task have in common.

    Attributes:
        title: What they are about.
        rows: What they are made of: a key of `evaluation.rendering.SHEETS`.
        more: The endings of further files.
    """

    title: str
    rows: str = "scores"
    more: tuple[str, ...] = ("_differences.csv",)


TASKS = {
    "csl": TaskTables("Learning"),
    "generation": TaskTables("Action generation"),
    "description": TaskTables("Action description"),
    "uncertain": TaskTables("Uncertain instructions", rows="answers", more=()),
}


@dataclass(frozen=True)
class Table:
    """One table: the part of the scores, or of the answers to uncertain instructions, that it shows.

    Attributes:
        title: Its heading.
        experiment: The experiment that it shows.
        tasks: Those whose measures are its columns, of those that are run; several have the same `rows`.
        D: The one number of trials that it shows, None for all.
        without: The variants that it leaves out.
    """

    title: str
    experiment: str
    tasks: tuple[str, ...]
    D: int | None = None
    without: tuple[str, ...] = ()

    @property
    def rows(self) -> str:
        """What it is made of."""
        return TASKS[self.tasks[0]].rows

    @property
    def endings(self) -> tuple[str, ...]:
        """How the names of its files end."""
        return (*(f".{form}" for form in TABLE_FORMS), *TASKS[self.tasks[0]].more)


# The tables of the paper: file name, number, experiment, tasks, D.
PAPER_TABLES = (
    ("table_1a", "1A", "simulator", ("csl",), 20),
    ("table_1b", "1B", "simulator", ("csl",), 40),
    ("table_2", "2", "simulator", ("generation",), None),
    ("table_3", "3", "simulator", ("description",), None),
    ("table_4", "4", "real", ("csl",), None),
    ("table_5", "5", "real", ("description", "generation"), None),
)


def tables_of(
    conditions: Iterable[tuple[str, str, int]], partial: Mapping[str, Sequence[str]] | None = None
) -> dict[str, Table]:
    """The tables of a study by file name: those of the paper that it can fill, and one for each experiment and task.

    Args:
        conditions: Each (experiment, task, D) that is run.
        partial: By experiment, the variants that are run for a part of the conditions only, as for one figure; the
            paper's tables leave them out, and those of the experiment show them.
    """
    run = set(conditions)
    tables = {}
    for name, number, experiment, all_tasks, D in PAPER_TABLES:
        tasks = tuple(task for task in all_tasks if any((experiment, task, D or d) in run for _, _, d in run))
        if tasks:
            which = _which_D(D or d for e, task, d in run if e == experiment and task in tasks)
            title = " and ".join(TASKS[task].title.lower() for task in tasks).capitalize()
            without = tuple((partial or {}).get(experiment, ()))
            tables[name] = Table(f"Table {number}. {title}, {experiment}{which}", experiment, tasks, D, without)
    for experiment, task in sorted({(experiment, task) for experiment, task, _ in run}):
        which = _which_D(D for e, t, D in run if (e, t) == (experiment, task))
        tables[f"{experiment}_{task}"] = Table(f"{TASKS[task].title}, {experiment}{which}", experiment, (task,))
    return tables


def _which_D(Ds: Iterable[int]) -> str:  # noqa: N802 (D is the paper's)
    """How a title names the D of a table that shows one only; a column tells several."""
    found = set(Ds)
    return f", D = {found.pop()}" if len(found) == 1 else ""


def files_of_tables(tables: Mapping[str, Table]) -> list[str]:
    """The names of all files of these tables."""
    return [f"{name}{ending}" for name, table in tables.items() for ending in table.endings]


def paper_table_with(experiment: str, task: str, D: int) -> str | None:
    """The name of the paper's table that shows a task of an experiment at a D; None where none does."""
    for name, _, of_experiment, tasks, of_D in PAPER_TABLES:
        if of_experiment == experiment and of_D in (None, D) and task in tasks:
            return name
    return None


def cell_name(condition: Mapping[Any, object], measure: str) -> str:
    """The id of a cell in the page of a table, to which other pages link."""
    return "{variant}-{sampler}-D{D}-ROW{ROW}-{method}-".format_map(condition) + measure
