"""The plan of a study: what a config asks for, as data that the rules enumerate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from data_collection.settings import Simulation
from features.settings import FeatureSettings
from workflow.config import ConfigError, default, key_path, read_config, schema_problems

CHANNELS = ("action", "position", "object", "color")
SHARED_KEYS = ("seed", "methods", "inference", "averaged_draws", "chains", "iterations", "empty_category")
# A hyperparameter of the config, and what model.Prior calls it.
HYPERPARAMETERS = {
    "K": "categories",
    "alpha": "concentration",
    "gamma": "word_concentration",
    "kappa0": "mean_strength",
    "V0": "scale",
    "nu0_minus_dim": "extra_freedom",
}


# Keys that say nothing where the data come from elsewhere.
USELESS_WITH = {
    "trials": ("features", "logs", "data"),
    "trials_per_job": ("features", "data"),
    "feature_extraction": ("features", "data"),
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
        changes = {"K": self.settings["K"], **self.settings["variants"][variant]}
        return {
            channel: {
                HYPERPARAMETERS[key]: value[channel] if isinstance(value, Mapping) else value
                for key, value in changes.items()
                if not isinstance(value, Mapping) or channel in value
            }
            for channel in CHANNELS
        }


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
                        for seed in range(1, settings["seeds"] + 1):
                            yield Condition(experiment, variant, method, inference, D, ROW, seed)

    def trials_needed(self, experiment: str) -> int:
        """How many training trials are simulated for an experiment's data."""
        users = [other for other in self.experiments.values() if other.data == experiment]
        largest = max(D for user in users for D in user.settings["D"])
        return int(self.experiments[experiment].settings.get("trials", largest))

    def blocks(self, experiment: str) -> list[tuple[int, ...]]:
        """The trials of an experiment, numbered from 1, in the blocks that one job simulates.

        Blocks are always whole, so that more trials mean more blocks and never another one.
        """
        size = self.experiments[experiment].settings["trials_per_job"]
        if self.experiments[experiment].source == "logs":
            count = len(log_folder_trials(self.log_folder(experiment)))
            trials = range(1, count + 1)
            return [tuple(trials[first : first + size]) for first in range(0, count, size)]
        needed = self.trials_needed(experiment)
        return [tuple(range(first, first + size)) for first in range(1, needed + 1, size)]

    def log_folder(self, experiment: str) -> Path:
        """The folder of logs that an experiment names."""
        return (self.folder / str(self.experiments[experiment].settings["logs"])).resolve()

    def figure_condition(self, experiment: str) -> Condition:
        """The condition that an experiment's figure of a fit shows, seed 1 standing for all seeds.

        The paper's Figure 4: most trials, fewest words omitted, the first method.
        """
        settings = self.experiments[experiment].settings
        methods = [method for method in settings["methods"] if method != "gmm"]
        method, ROW = (methods[0], min(settings["ROW"])) if methods else ("gmm", 100)
        wanted = {"method": method, "ROW": ROW, "D": max(settings["D"]), "seed": 1}
        return next(c for c in self.conditions(experiment) if vars(c).items() >= wanted.items())


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


def load_study(path: Path) -> Study:
    """Read, check and complete a config file.

    Raises:
        ConfigError: with everything that is wrong.
    """
    return plan(read_config(path), path)


def plan(config: Mapping[str, Any], path: Path) -> Study:
    """Check a config and fill in its defaults; `path` is the file that it came from.

    Raises:
        ConfigError: with everything that is wrong.
    """
    problems = schema_problems(config)
    if problems:
        raise ConfigError(str(path), problems)
    experiments = {name: _complete(name, config) for name in config["experiments"]}
    problems = [problem for name in experiments for problem in _contradictions(name, config)]
    if problems:
        raise ConfigError(str(path), problems)
    study = Study(experiments, path.parent)
    problems = [problem for name in experiments for problem in _data_problems(study, name)]
    if problems:
        raise ConfigError(str(path), problems)
    return study


def _complete(name: str, config: Mapping[str, Any]) -> Experiment:
    own = config["experiments"][name]
    shared = {key: config[key] for key in SHARED_KEYS if key in config}
    optional = (*SHARED_KEYS, "ROW", "seeds", "K", "variants", "trials_per_job")
    settings = {key: default(key) for key in optional} | shared | own
    owner = config["experiments"].get(own.get("data"), {})
    if "words" not in own and "words" in owner:
        settings["words"] = owner["words"]
    source = next((kind for kind in ("features", "logs") if kind in own), "simulation")
    return Experiment(name, source, own.get("data", name), settings)


def _contradictions(name: str, config: Mapping[str, Any]) -> Iterator[str]:
    """What no single key shows: keys that exclude each other, words in two channels, references to nothing."""
    experiments = config["experiments"]
    own, where = experiments[name], key_path(["experiments", name])
    sources = [key for key in ("features", "logs", "data", "simulation") if key in own]
    if len(sources) > 1:
        yield f"{where}: {' and '.join(sources)} exclude each other: data have one source"
    for key, sources_without in USELESS_WITH.items():
        for source in sources_without:
            if key in own and source in own:
                yield f"{where}.{key}: has no effect with {source} (remove it)"
    owner = own.get("data", name)
    if owner not in experiments or (owner == name and "data" in own):
        others = ", ".join(sorted(set(experiments) - {name})) or "there is none"
        yield f"{where}.data: {owner!r} is no other experiment (allowed: {others})"
        return
    if "data" in experiments[owner] and owner != name:
        yield f"{where}.data: {owner} has no data of its own but shares those of {experiments[owner]['data']}"
    words = own.get("words", experiments[owner].get("words"))
    if words is None:
        yield f"{where}: key 'words' is missing (the words by channel: the true channel of each word)"
        return
    for i, channel in enumerate(CHANNELS):
        for other in CHANNELS[i + 1 :]:
            for word in sorted(set(words[channel]) & set(words[other])):
                yield f"{where}.words: {word!r} is a word of {channel} and of {other} (allowed: one channel a word)"
    trials = experiments[owner].get("trials")
    for i, D in enumerate(own["D"]):
        if trials is not None and D > trials:
            yield f"{where}.D[{i}]: {D} is more than the {trials} trials collected (experiments.{owner}.trials)"


def _data_problems(study: Study, name: str) -> Iterator[str]:
    """What the data themselves forbid: settings of the simulation, files of one's own."""
    experiment = study.experiments[name]
    where = key_path(["experiments", name])
    if experiment.data != name:
        return
    if experiment.source != "features":
        try:
            FeatureSettings.from_mapping(experiment.settings.get("feature_extraction", {}))
        except ValueError as error:
            yield from (f"{where}.feature_extraction: {line}" for line in str(error).splitlines())
    if experiment.source == "simulation":
        try:
            simulation = Simulation.from_mapping(experiment.settings.get("simulation", {}))
        except ValueError as error:
            yield from (f"{where}.simulation: {line}" for line in str(error).splitlines())
        else:
            yield from (f"{where}.simulation: {line}" for line in simulation.check_words(experiment.words))
    if experiment.source == "logs":
        yield from _log_problems(study, experiment)
    if experiment.source == "features":
        yield from _table_problems(study, experiment)


def _log_problems(study: Study, experiment: Experiment) -> Iterator[str]:
    where = key_path(["experiments", experiment.name, "logs"])
    folder = study.log_folder(experiment.name)
    if not (folder / "calibration.mcap").is_file():
        yield f"{where}: {folder / 'calibration.mcap'} is not a file (the log of the camera's calibration)"
    count = len(log_folder_trials(folder))
    needed = max(D for user in study.experiments.values() if user.data == experiment.name for D in user.settings["D"])
    if count < needed:
        yield (
            f"{where}: D is up to {needed}, but {folder / 'train'} holds {count} logs numbered without a gap "
            "(trial_0001.mcap, trial_0002.mcap, …)"
        )


def log_folder_trials(folder: Path) -> list[Path]:
    """The training logs trial_0001.mcap, trial_0002.mcap, … of a folder, up to the first gap."""
    present: list[Path] = []
    while (path := folder / "train" / f"trial_{len(present) + 1:04}.mcap").is_file():
        present.append(path)
    return present


def _table_problems(study: Study, experiment: Experiment) -> Iterator[str]:
    from features.table import check_table, read_table

    where = key_path(["experiments", experiment.name, "features"])
    paths = feature_files(study, experiment.name)
    missing = [f"{where}.{key}: {path} is not a file" for key, path in paths.items() if not path.is_file()]
    if missing:
        yield from missing
        return
    problems = check_table(
        **{f"{key}_path": path for key, path in paths.items()}, words=experiment.words, need_attention=True
    )
    if problems:
        yield from (f"{where}: {problem}" for problem in problems)
        return
    table = read_table(paths["trials"], paths["objects"], need_attention=True)
    for user in study.experiments.values():
        if user.data != experiment.name:
            continue
        for i, D in enumerate(user.settings["D"]):
            if D > len(table.trial):
                yield (
                    f"experiments.{user.name}.D[{i}]: {D} is more than the {len(table.trial)} trials "
                    f"of {paths['trials']}"
                )
        for row, sentence in enumerate(table.words):
            if len(sentence) > len(CHANNELS) and "proposed" in user.settings["methods"]:
                yield (
                    f"{where}: {paths['trials']}, trial {table.trial[row]}: {len(sentence)} words, but "
                    f"method proposed explains at most {len(CHANNELS)} (one a channel)"
                )


def feature_files(study: Study, experiment: str) -> dict[str, Path]:
    """The two Parquet files that an experiment with features of its own names."""
    named = study.experiments[experiment].settings["features"]
    return {key: (study.folder / named[key]).resolve() for key in ("trials", "objects")}
