"""What is wrong with feature tables that an experiment names, and what stands out in them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from model.methods import METHODS
from workflow.plan.config_types import CHANNELS
from workflow.plan.experiment import Experiment
from workflow.plan.problems import key_path
from workflow.plan.study import Study, feature_files
from workflow.plan.units import unlikely_units


def named_by(experiment: Experiment, key: str) -> list[str | int]:
    """The key that names the files of a data set, with its place where it is a list."""
    listed = isinstance(getattr(experiment.settings, key), tuple)
    return ["experiments", experiment.title, key, *([experiment.dataset - 1] if listed else [])]


def braces(where: str, path: Path) -> Iterator[str]:
    """A path that Snakemake would take for a pattern."""
    if set("{}") & set(str(path)):
        yield f"{where}: {path} has {{ or }} in it, which Snakemake would fill in (rename the file or its folder)"


def too_long(study: Study, experiment: Experiment, words: int) -> str:
    """Say why a sentence of so many words is too long for what is fitted to a data set; empty if it is not."""
    methods = [name for user in study.users(experiment.name) for name in user.settings.methods]
    for name in methods:
        if words > METHODS[name].frame_prior.word_limit(len(CHANNELS)):
            return f"{words} words, but method {name} explains at most {len(CHANNELS)} (one per channel)"
    return ""


def table_problems(study: Study, experiment: Experiment, set_name: str, notes: list[str]) -> Iterator[str]:
    """What is wrong with the feature tables of a set of an experiment; `notes` gets what merely stands out."""
    from features.table import TableError, import_with_notes

    where = key_path([*named_by(experiment, "features"), *([] if set_name == "train" else [set_name])])
    paths = feature_files(study, experiment.name, set_name)
    for key, path in paths.items():
        yield from braces(f"{where}.{key}", path)
    missing = [f"{where}.{key}: {path} is not a file" for key, path in paths.items() if not path.exists()]
    if missing:
        yield from missing
        return
    need_attention = set_name != "generation"
    try:
        table, told = import_with_notes(**paths, words=experiment.words, need_attention=need_attention)
    except TableError as error:
        yield from (f"{where}: {problem}" for problem in error.problems)
        return
    notes += told
    if set_name == "description" and not any(table.words):
        yield (
            f"{where}: {paths['trials']}: no trial says a word, so there is nothing to compare descriptions with "
            f"({key_path(['experiments', experiment.title])}.description.actions: 0 leaves the task out)"
        )
    if set_name != "train":
        return
    notes += unlikely_units(study, experiment, table, paths)
    for user in study.users(experiment.name):
        for i, D in enumerate(user.settings.D):
            if D > len(table.trial):
                yield (
                    f"experiments.{user.title}.D[{i}]: {D} is more than the {len(table.trial)} trials "
                    f"of {paths['trials']}"
                )
            if D in study.tested_D(user.name, "description") and not any(table.words[:D]):
                yield (
                    f"experiments.{user.title}.D[{i}]: none of the first {D} trials of {paths['trials']} says a "
                    "word, so the robot learns none to describe with (description.actions: 0 leaves the task out)"
                )
    for row, sentence in enumerate(table.words):
        if problem := too_long(study, experiment, len(sentence)):
            yield f"{where}: {paths['trials']}, trial {table.trial[row]}: {problem}"
