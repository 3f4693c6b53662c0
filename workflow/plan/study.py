"""The plan of a study: what a config asks for, as data that the rules enumerate."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

from model.prior import Prior
from workflow.plan.config_types import WORDLESS, Channel
from workflow.plan.study_config import ExperimentConfig, Task
from workflow.plan.variants import HYPERPARAMETERS, hyperparameters

# The tasks that use what was learned, and the key that says how many trials test it.
TASKS = {"generation": "sentences", "description": "actions"}


@dataclass(frozen=True)
class Experiment:
    """One experiment.

    Attributes:
        name: Its name.
        data: Name of the experiment whose data it uses, its own name where it has its own.
        words: The words by channel.
        settings: Every key of its config, completed.
    """

    name: str
    data: str
    words: Mapping[str, list[str]]
    settings: ExperimentConfig

    @property
    def source(self) -> str:
        """Where its data come from: `simulation`, `logs` or `features`."""
        return next((kind for kind in ("features", "logs") if getattr(self.settings, kind) is not None), "simulation")

    def task(self, name: str) -> Task:
        """The settings of a task."""
        task: Task = getattr(self.settings, name)
        return task

    def test_trials(self, task: str) -> int:
        """How many trials are asked for to test a task."""
        return int(getattr(self.task(task), TASKS[task]))

    def priors(self, variant: str) -> dict[Channel, Prior]:
        """The hyperparameters of a variant by channel."""
        changed = self.settings.variants[variant]
        changes = [(key, getattr(changed, key)) for key in HYPERPARAMETERS if key in changed.model_fields_set]
        return hyperparameters([("K", self.settings.K), *changes])

    @property
    def partial_variants(self) -> list[str]:
        """Variants that are run for a part of the conditions, beside others; never `default`: claims rest on it."""
        variants = self.settings.variants
        partial = [name for name, own in variants.items() if own.only.model_fields_set and name != "default"]
        return partial if len(partial) < len(variants) else []

    def is_run(self, condition: Condition) -> bool:
        """Whether a variant is run for a condition; a method without words is the same at every ROW."""
        only = self.settings.variants[condition.variant].only
        return (
            condition.method in (only.methods or [condition.method])
            and condition.sampler in (only.samplers or [condition.sampler])
            and condition.D in (only.D or [condition.D])
            and (condition.method in WORDLESS or condition.ROW in (only.ROW or [condition.ROW]))
        )


@dataclass(frozen=True)
class Condition:
    """The names of one fit."""

    experiment: str
    variant: str
    method: str
    sampler: str
    D: int
    ROW: int
    seed: int

    @property
    def path(self) -> str:
        """Where the fit is, below the output folder."""
        return FIT_PATH.format(**vars(self))


FIT_PATH = "fits/{experiment}/{variant}/{method}/{sampler}/D{D}/ROW{ROW}/seed{seed}.npz"


@dataclass(frozen=True)
class Study:
    """A checked config.

    Attributes:
        experiments: The experiments by name.
        folder: The folder of the config file, to which its paths are relative.
    """

    experiments: Mapping[str, Experiment]
    folder: Path

    def conditions(self, experiment: str) -> Iterator[Condition]:
        """Every fit of an experiment, the reference ALL (`gmm` at ROW 100) included."""
        own = self.experiments[experiment]
        settings = own.settings
        methods = [method for method in settings.methods if method not in WORDLESS]
        grid = [(method, ROW) for method in methods for ROW in settings.ROW] + [(method, 100) for method in WORDLESS]
        for variant, sampler, D in product(settings.variants, settings.samplers, settings.D):
            for method, ROW in grid:
                first = Condition(experiment, variant, method, sampler, D, ROW, 1)
                if own.is_run(first):
                    yield from self.seeds(first)

    def size(self, experiment: str) -> int:
        """At most so many jobs fit and simulate an experiment; known without listing them."""
        own = self.experiments[experiment]
        settings = own.settings
        grid = len(settings.variants) * len(settings.samplers) * len(settings.D)
        fits = grid * (len(settings.methods) * len(settings.ROW) + 1) * settings.seeds
        simulated = own.source == "simulation" and own.data == experiment
        trials = len(self.trials(experiment, "train")) if simulated else 0
        return fits + trials // settings.trials_per_job

    def task_conditions(self, experiment: str, task: str) -> list[Condition]:
        """The fits that a task (`generation`, `description`) tests; none where there is nothing to test them on."""
        asked = self.experiments[experiment].task(task)
        if not self.is_tested(experiment, task):
            return []
        return [
            condition
            for condition in self.conditions(experiment)
            if condition.method not in WORDLESS and condition.D in asked.D and condition.ROW in asked.ROW
        ]

    def is_tested(self, experiment: str, task: str) -> bool:
        """Whether a task is asked for, and there are trials to test it on."""
        own = self.experiments[experiment]
        return own.test_trials(task) > 0 and len(self.trials(own.data, task)) > 0

    def tested_D(self, experiment: str, task: str) -> list[int]:  # noqa: N802 (D is the paper's)
        """The numbers of trials of the fits that a task tests, in rising order."""
        return sorted({condition.D for condition in self.task_conditions(experiment, task)})

    def trials(self, experiment: str, set_name: str) -> range:
        """The trials, numbered from 1, of a set of the data of an experiment that has data of its own.

        Training trials are simulated in whole jobs, so that a larger D adds jobs and never changes another one.
        For features of one's own, of which only the file knows, a set that is there counts as one trial.
        """
        own = self.experiments[experiment]
        if own.source == "logs":
            return range(1, len(log_folder_trials(self.log_folder(experiment), set_name)) + 1)
        if own.settings.features is not None:
            return range(1, 2 if set_name == "train" or getattr(own.settings.features, set_name) else 1)
        if set_name != "train":
            return range(1, own.test_trials(set_name) + 1)
        users = [other for other in self.experiments.values() if other.data == experiment]
        needed = own.settings.trials or max(D for user in users for D in user.settings.D)
        size = own.settings.trials_per_job
        return range(1, -(-needed // size) * size + 1)

    def blocks(self, experiment: str, set_name: str = "train") -> list[tuple[int, ...]]:
        """The trials of a set in the blocks that one job simulates or looks at."""
        size = self.experiments[experiment].settings.trials_per_job
        trials = self.trials(experiment, set_name)
        return [tuple(trials[first : first + size]) for first in range(0, len(trials), size)]

    def log_folder(self, experiment: str) -> Path:
        """The folder of logs that an experiment names."""
        return (self.folder / str(self.experiments[experiment].settings.logs)).resolve()

    def weights_file(self, experiment: str) -> Path | None:
        """The file of the network's weights that an experiment names; None where they are `seeded` or published."""
        weights = self.experiments[experiment].settings.feature_extraction.weights
        return None if weights in ("seeded", "imagenet1k") else (self.folder / weights).resolve()

    def figure_condition(self, experiment: str) -> Condition | None:
        """The condition that an experiment's figures of a fit show, seed 1 standing for all seeds.

        What the key `figure` leaves open is as in the paper's Figure 4: the first variant, method and sampler, most
        trials, fewest words omitted. None where nothing is run that the key asks for.
        """
        asked = self.experiments[experiment].settings.figure.model_dump(exclude_unset=True)
        return self._first(experiment, self.conditions(experiment), asked)

    def generation_condition(self, experiment: str) -> Condition | None:
        """The condition whose generated actions a figure shows, chosen likewise; None without the task."""
        return self._first(experiment, self.task_conditions(experiment, "generation"), {})

    def _first(self, experiment: str, run: Iterable[Condition], asked: Mapping[str, Any]) -> Condition | None:
        settings = self.experiments[experiment].settings
        variants, samplers, methods = list(settings.variants), list(settings.samplers), [*settings.methods, *WORDLESS]
        return min(
            (condition for condition in run if condition.seed == 1 and vars(condition).items() >= asked.items()),
            # A method that hears no word is shown only where nothing else is run.
            key=lambda c: (
                c.method in WORDLESS,
                variants.index(c.variant),
                methods.index(c.method),
                samplers.index(c.sampler),
                -c.D,
                c.ROW,
            ),
            default=None,
        )

    def seeds(self, condition: Condition) -> list[Condition]:
        """The condition with each seed."""
        return [
            replace(condition, seed=seed)
            for seed in range(1, self.experiments[condition.experiment].settings.seeds + 1)
        ]


def log_folder_trials(folder: Path, set_name: str) -> list[Path]:
    """The logs trial_0001.mcap, trial_0002.mcap, … of a set in a folder, up to the first gap."""
    present: list[Path] = []
    while (path := folder / set_name / f"trial_{len(present) + 1:04}.mcap").is_file():
        present.append(path)
    return present


def feature_files(study: Study, experiment: str, set_name: str = "train") -> dict[str, Path]:
    """The two Parquet files of a set that an experiment with features of its own names."""
    named: Any = study.experiments[experiment].settings.features
    named = named if set_name == "train" else getattr(named, set_name)
    return {key: (study.folder / getattr(named, key)).resolve() for key in ("trials", "objects")}
