"""The plan of a study: what a config asks for, as data that the rules enumerate."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

CHANNELS = ("action", "position", "object", "color")
SHARED_KEYS = (
    "seed",
    "methods",
    "inference",
    "averaged_draws",
    "chains",
    "iterations",
    "empty_category",
    "temperature",
    "keep_history",
)
# The tasks that use what was learned, and the key that says how many trials test it.
TASKS = {"generation": "sentences", "description": "actions"}
# A hyperparameter of the config, and what model.Prior calls it.
HYPERPARAMETERS = {
    "K": "categories",
    "alpha": "concentration",
    "gamma": "word_concentration",
    "kappa0": "mean_precision",
    "V0": "scale",
    "nu0_minus_dim": "extra_degrees_of_freedom",
}


@dataclass(frozen=True)
class Experiment:
    """One experiment with all its settings, defaults filled in. `settings` holds the keys of the config schema.

    Attributes:
        name: its name.
        source: `simulation`, `logs` or `features`: where its data come from.
        data: name of the experiment whose data it uses, its own name where it has its own.
        settings: every key of an experiment that has a value.
    """

    name: str
    source: str
    data: str
    settings: Mapping[str, Any]

    @property
    def words(self) -> dict[str, list[str]]:
        """The words by channel."""
        return {channel: list(self.settings["words"][channel]) for channel in CHANNELS}

    def priors(self, variant: str) -> dict[str, dict[str, Any]]:
        """The hyperparameters of a variant as arguments of `model.Prior`, by channel."""
        priors: dict[str, dict[str, Any]] = {channel: {} for channel in CHANNELS}
        for changes in ({"K": self.settings["K"]}, self.settings["variants"][variant]):
            for key, value in changes.items():
                if key in HYPERPARAMETERS:
                    by_channel = value if isinstance(value, Mapping) else dict.fromkeys(CHANNELS, value)
                    for channel, number in by_channel.items():
                        priors[channel][HYPERPARAMETERS[key]] = number
        return priors

    @property
    def partial_variants(self) -> list[str]:
        """Variants that are run for a part of the conditions, beside others; never `default`: claims rest on it."""
        variants = self.settings["variants"]
        partial = [name for name, own in variants.items() if "only" in own and name != "default"]
        return partial if len(partial) < len(variants) else []

    def is_run(self, variant: str, method: str, D: int, ROW: int) -> bool:
        """Whether a variant is run for a condition; ALL (`gmm`) is the same at every ROW."""
        only = self.settings["variants"][variant].get("only", {})
        return (
            method in only.get("methods", [method])
            and D in only.get("D", [D])
            and (method == "gmm" or ROW in only.get("ROW", [ROW]))
        )


@dataclass(frozen=True)
class Condition:
    """The names of one fit."""

    experiment: str
    variant: str
    method: str
    inference: str
    D: int
    ROW: int
    seed: int

    @property
    def path(self) -> str:
        """Where the fit is, below the output folder."""
        return FIT_PATH.format(**vars(self))


FIT_PATH = "fits/{experiment}/{variant}/{method}/{inference}/D{D}/ROW{ROW}/seed{seed}.npz"


@dataclass(frozen=True)
class Study:
    """A checked config.

    Attributes:
        experiments: the experiments by name.
        folder: the folder of the config file, to which its paths are relative.
    """

    experiments: Mapping[str, Experiment]
    folder: Path

    def conditions(self, experiment: str) -> Iterator[Condition]:
        """Every fit of an experiment, the reference ALL (`gmm` at ROW 100) included."""
        settings = self.experiments[experiment].settings
        methods = [method for method in settings["methods"] if method != "gmm"]
        grid = [(method, ROW) for method in methods for ROW in settings["ROW"]] + [("gmm", 100)]
        for variant in settings["variants"]:
            for inference in inference_names(settings):
                for D in settings["D"]:
                    for method, ROW in grid:
                        if not self.experiments[experiment].is_run(variant, method, D, ROW):
                            continue
                        for seed in range(1, settings["seeds"] + 1):
                            yield Condition(experiment, variant, method, inference, D, ROW, seed)

    def size(self, experiment: str) -> int:
        """At most so many jobs fit and simulate an experiment; known without listing them."""
        settings = self.experiments[experiment].settings
        grid = len(settings["variants"]) * len(inference_names(settings)) * len(settings["D"])
        fits = grid * (len(settings["methods"]) * len(settings["ROW"]) + 1) * settings["seeds"]
        own = self.experiments[experiment]
        simulated = own.source == "simulation" and own.data == experiment
        trials = len(self.trials(experiment, "train")) if simulated else 0
        return int(fits + trials // settings["trials_per_job"])

    def task_conditions(self, experiment: str, task: str) -> list[Condition]:
        """The fits that a task (`generation`, `description`) tests; none where there is nothing to test them on."""
        asked = self.experiments[experiment].settings[task]
        if not self.is_tested(experiment, task):
            return []
        return [
            condition
            for condition in self.conditions(experiment)
            if condition.method != "gmm" and condition.D in asked["D"] and condition.ROW in asked["ROW"]
        ]

    def is_tested(self, experiment: str, task: str) -> bool:
        """Whether a task is asked for, and there are trials to test it on."""
        own = self.experiments[experiment]
        return own.settings[task][TASKS[task]] > 0 and len(self.trials(own.data, task)) > 0

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
        if own.source == "features":
            return range(1, 2 if set_name == "train" or set_name in own.settings["features"] else 1)
        if set_name != "train":
            return range(1, own.settings[set_name][TASKS[set_name]] + 1)
        users = [other for other in self.experiments.values() if other.data == experiment]
        needed = own.settings.get("trials", max(D for user in users for D in user.settings["D"]))
        size = own.settings["trials_per_job"]
        return range(1, -(-needed // size) * size + 1)

    def blocks(self, experiment: str, set_name: str = "train") -> list[tuple[int, ...]]:
        """The trials of a set in the blocks that one job simulates or looks at."""
        size = self.experiments[experiment].settings["trials_per_job"]
        trials = self.trials(experiment, set_name)
        return [tuple(trials[first : first + size]) for first in range(0, len(trials), size)]

    def log_folder(self, experiment: str) -> Path:
        """The folder of logs that an experiment names."""
        return (self.folder / str(self.experiments[experiment].settings["logs"])).resolve()

    def weights_file(self, experiment: str) -> Path | None:
        """The file of the network's weights that an experiment names; None where they are `seeded` or published."""
        weights = self.experiments[experiment].settings.get("feature_extraction", {}).get("weights", "seeded")
        return None if weights in ("seeded", "imagenet1k") else (self.folder / weights).resolve()

    def figure_condition(self, experiment: str) -> Condition | None:
        """The condition that an experiment's figures of a fit show, seed 1 standing for all seeds.

        What the key `figure` leaves open is as in the paper's Figure 4: the first variant and method, most trials,
        fewest words omitted. None where nothing is run that the key asks for.
        """
        return self._first(experiment, self.conditions(experiment), self.experiments[experiment].settings["figure"])

    def generation_condition(self, experiment: str) -> Condition | None:
        """The condition whose generated actions a figure shows, chosen likewise; None without the task."""
        return self._first(experiment, self.task_conditions(experiment, "generation"), {})

    def _first(self, experiment: str, run: Iterable[Condition], asked: Mapping[str, Any]) -> Condition | None:
        settings = self.experiments[experiment].settings
        variants, methods = list(settings["variants"]), [*settings["methods"], "gmm"]
        return min(
            (condition for condition in run if condition.seed == 1 and vars(condition).items() >= asked.items()),
            # ALL, which hears no word, is shown only where nothing else is run.
            key=lambda c: (c.method == "gmm", variants.index(c.variant), methods.index(c.method), -c.D, c.ROW),
            default=None,
        )

    def seeds(self, condition: Condition) -> list[Condition]:
        """The condition with each seed."""
        return [
            replace(condition, seed=seed)
            for seed in range(1, self.experiments[condition.experiment].settings["seeds"] + 1)
        ]


def inference_names(settings: Mapping[str, Any]) -> list[str]:
    """The inference folders: the sampler, with the number of averaged draws where it is not 1."""
    return [
        inference if draws == 1 else f"{inference}_averaged{draws}"
        for inference in settings["inference"]
        for draws in (settings["averaged_draws"] if inference == "blocked" else [1])
    ]


def averaged_draws(inference: str) -> int:
    """The number of averaged draws that an inference folder's name says."""
    _, _, draws = inference.partition("_averaged")
    return int(draws or 1)


def log_folder_trials(folder: Path, set_name: str) -> list[Path]:
    """The logs trial_0001.mcap, trial_0002.mcap, … of a set in a folder, up to the first gap."""
    present: list[Path] = []
    while (path := folder / set_name / f"trial_{len(present) + 1:04}.mcap").is_file():
        present.append(path)
    return present


def feature_files(study: Study, experiment: str, set_name: str = "train") -> dict[str, Path]:
    """The two Parquet files of a set that an experiment with features of its own names."""
    named = study.experiments[experiment].settings["features"]
    named = named if set_name == "train" else named[set_name]
    return {key: (study.folder / named[key]).resolve() for key in ("trials", "objects")}
