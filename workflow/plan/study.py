"""The plan of a study: what a config asks for, as data that the rules enumerate."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

from workflow.plan.conditions import Condition
from workflow.plan.config_types import WORDLESS
from workflow.plan.experiment import Experiment, log_folder_trials


@dataclass(frozen=True)
class Study:
    """A checked config.

    Attributes:
        experiments: Every data set of every experiment, by name: an experiment of one data set is this.
        folder: The folder of the config file, to which its paths are relative.
        notes: What a reader should know of the data that the config names, though nothing is wrong with it.
    """

    experiments: Mapping[str, Experiment]
    folder: Path
    notes: tuple[str, ...] = ()

    @property
    def first_sets(self) -> dict[str, Experiment]:
        """The first data set of each experiment, by the experiment's name: what is told of it as a whole."""
        return {name: own for name, own in self.experiments.items() if own.dataset == 1}

    def sets(self, experiment: str) -> list[str]:
        """The names of all data sets of an experiment, the first of which has its name; none of an unknown one."""
        return [name for name, own in self.experiments.items() if own.title == experiment]

    def users(self, experiment: str) -> list[Experiment]:
        """The data sets that use the data of one, itself included where it has its own."""
        return [user for user in self.experiments.values() if user.data == experiment]

    def conditions(self, experiment: str) -> Iterator[Condition]:
        """Every fit of a data set of an experiment, the reference ALL (`gmm` at ROW 100) included."""
        own = self.experiments[experiment]
        settings = own.settings
        methods = [method for method in settings.methods if method not in WORDLESS]
        grid = [(method, ROW) for method in methods for ROW in settings.ROW] + [(method, 100) for method in WORDLESS]
        for variant, sampler, D in product(settings.variants, settings.samplers, settings.D):
            for method, ROW in grid:
                first = Condition(own.title, variant, method, sampler, D, ROW, 1, own.dataset)
                if own.is_run(first):
                    yield from self.seeds(first)

    def chains(self, condition: Condition) -> list[str]:
        """The fits that are chains of one posterior, for the seeds of a condition.

        Where each seed omits words of its own, they are several chains of what the first seed hears.
        """
        if condition.ROW in (0, 100):  # every seed hears the same words, all or none
            return [one.path for one in self.seeds(condition)]
        first, count = replace(condition, seed=1), self.experiments[condition.experiment].settings.diagnostics.chains
        return [first.chain_path(chain) for chain in range(1, max(count, 1) + 1)]

    def size(self, experiment: str) -> int:
        """At most so many jobs fit and simulate a data set of an experiment; known without listing them."""
        own = self.experiments[experiment]
        settings = own.settings
        grid = len(settings.variants) * len(settings.samplers) * len(settings.D)
        fits = grid * (len(settings.methods) * len(settings.ROW) + 1) * settings.seeds
        fits += (
            grid * len(settings.methods) * len(set(settings.ROW) - {0, 100}) * max(settings.diagnostics.chains - 1, 0)
        )
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
            if condition.method not in WORDLESS
            and condition.sampler in (asked.samplers or [condition.sampler])
            and condition.D in asked.D
            and condition.ROW in asked.ROW
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
        if own.features is not None:
            return range(1, 2 if set_name == "train" or getattr(own.features, set_name) else 1)
        if set_name != "train":
            return range(1, own.test_trials(set_name) + 1)
        needed = own.settings.trials or max(D for user in self.users(experiment) for D in user.settings.D)
        size = own.settings.trials_per_job
        return range(1, -(-needed // size) * size + 1)

    def blocks(self, experiment: str, set_name: str = "train") -> list[tuple[int, ...]]:
        """The trials of a set in the blocks that one job simulates or looks at."""
        size = self.experiments[experiment].settings.trials_per_job
        trials = self.trials(experiment, set_name)
        return [tuple(trials[first : first + size]) for first in range(0, len(trials), size)]

    def log_folder(self, experiment: str) -> Path:
        """The folder of logs that an experiment names."""
        return (self.folder / str(self.experiments[experiment].logs)).resolve()

    def weights_file(self, experiment: str) -> Path | None:
        """The file of the network's weights that an experiment names; None where they are `seeded` or published."""
        weights = self.experiments[experiment].settings.feature_extraction.weights
        return None if weights in ("seeded", "imagenet1k") else (self.folder / weights).resolve()

    def figure_conditions(self, experiment: str) -> dict[str, Condition | None]:
        """The conditions that an experiment's figures of a fit show, by the ending that tells their samplers apart.

        Seed 1 stands for all seeds. What the key `figure` leaves open is as in the paper's Figure 4: the first
        variant, method and sampler, most trials, fewest words omitted. None where nothing is run that the key asks
        for.

        Returns:
            One condition by the name "", or several by names as `_mixing`.
        """
        asked = self.experiments[experiment].settings.figure.model_dump(exclude_unset=True)
        samplers = asked.pop("samplers", ())
        each = [{"sampler": sampler} for sampler in samplers] or [{}]
        found = [self._first(experiment, self.conditions(experiment), asked | one) for one in each]
        return dict(zip([f"_{name}" for name in samplers] if len(samplers) > 1 else [""], found, strict=True))

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


def feature_files(study: Study, experiment: str, set_name: str = "train") -> dict[str, Path]:
    """The two Parquet files of a set that an experiment with features of its own names."""
    named: Any = study.experiments[experiment].features
    named = named if set_name == "train" else getattr(named, set_name)
    return {key: (study.folder / getattr(named, key)).resolve() for key in ("trials", "objects")}
