"""An experiment of the plan: one data set of it, and everything that the config says of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from data_collection.log.numbering import file_of_trial
from evaluation.data_sets import data_set_name
from model.methods import METHODS
from model.prior import Prior
from workflow.plan.conditions import Condition
from workflow.plan.config_types import WORDLESS, Channel
from workflow.plan.study_config import ExperimentConfig, FeatureTables, Task
from workflow.plan.variants import HYPERPARAMETERS, hyperparameters

# The tasks that use what was learned, and the key that says how many trials test it.
TASKS = {"generation": "sentences", "description": "actions"}


@dataclass(frozen=True)
class Experiment:
    """One data set of an experiment, with all its conditions.

    Attributes:
        name: What files and draws call it, see `data_set_name`; of the first data set the experiment's name.
        data: Name of the data set that it uses, its own name where it has its own.
        words: The words by channel.
        settings: Every key of its config, completed; the same for all data sets of an experiment.
        dataset: Which of them it is, from 1.
    """

    name: str
    data: str
    words: Mapping[str, list[str]]
    settings: ExperimentConfig
    dataset: int = 1

    @property
    def title(self) -> str:
        """The experiment's name in the config."""
        return self.name.removesuffix(data_set_name("", self.dataset))

    @property
    def features(self) -> FeatureTables | None:
        """The feature tables that the config names for this data set."""
        named = self.settings.features
        return named[self.dataset - 1] if isinstance(named, tuple) else named

    @property
    def logs(self) -> str | None:
        """The folder of logs that the config names for this data set."""
        named = self.settings.logs
        return named[self.dataset - 1] if isinstance(named, tuple) else named

    @property
    def source(self) -> str:
        """Where its data come from: `simulation`, `logs` or `features`."""
        return next((kind for kind in ("features", "logs") if getattr(self, kind) is not None), "simulation")

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
        """Whether a condition is run; a method without words is the same at every ROW."""
        only = self.settings.variants[condition.variant].only
        return (
            self.settings.samplers[condition.sampler].takes(METHODS[condition.method])
            and condition.method in (only.methods or [condition.method])
            and condition.sampler in (only.samplers or [condition.sampler])
            and condition.D in (only.D or [condition.D])
            and (condition.method in WORDLESS or condition.ROW in (only.ROW or [condition.ROW]))
        )


def log_folder_trials(folder: Path, set_name: str) -> list[Path]:
    """The logs trial_0001.mcap, trial_0002.mcap, … of a set in a folder, up to the first gap; D counts them."""
    present: list[Path] = []
    while (path := folder / set_name / file_of_trial(len(present) + 1)).is_file():
        present.append(path)
    return present
