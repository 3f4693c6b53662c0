"""What no single key of a config shows: contradictions between keys, and what the data themselves forbid."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from data_collection.settings import Simulation
from features.settings import FeatureSettings
from workflow.config import key_path
from workflow.study import CHANNELS, TASKS, Experiment, Study, feature_files, log_folder_trials

# Keys that say nothing where the data come from elsewhere.
USELESS_WITH = {
    "trials": ("features", "logs", "data"),
    "trials_per_job": ("features", "data"),
    "feature_extraction": ("features", "data"),
}


def contradictions(name: str, config: Mapping[str, Any]) -> Iterator[str]:
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
    for task in TASKS:
        for key, available in (("D", own["D"]), ("ROW", own.get("ROW", [0]))):
            for i, value in enumerate(own.get(task, {}).get(key, ())):
                if value not in available:
                    allowed = ", ".join(map(str, available))
                    yield f"{where}.{task}.{key}[{i}]: {value} is not run (allowed: {allowed}, from {where}.{key})"
    trials = experiments[owner].get("trials")
    for i, D in enumerate(own["D"]):
        if trials is not None and D > trials:
            yield f"{where}.D[{i}]: {D} is more than the {trials} trials collected (experiments.{owner}.trials)"


def data_problems(study: Study, name: str) -> Iterator[str]:
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
        weights = study.weights_file(name)
        if weights is not None and not weights.is_file():
            yield f"{where}.feature_extraction.weights: {weights} is not a file (nor seeded, nor imagenet1k)"
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
    count = len(log_folder_trials(folder, "train"))
    needed = max(D for user in study.experiments.values() if user.data == experiment.name for D in user.settings["D"])
    if count < needed:
        yield (
            f"{where}: D is up to {needed}, but {folder / 'train'} holds {count} logs numbered without a gap "
            "(trial_0001.mcap, trial_0002.mcap, …)"
        )


def _table_problems(study: Study, experiment: Experiment) -> Iterator[str]:
    for set_name in ("train", *TASKS):
        if study.trials(experiment.name, set_name):
            yield from _problems_of_set(study, experiment, set_name)


def _problems_of_set(study: Study, experiment: Experiment, set_name: str) -> Iterator[str]:
    from features.table import check_table, read_table

    where = key_path(["experiments", experiment.name, "features", *([] if set_name == "train" else [set_name])])
    paths = feature_files(study, experiment.name, set_name)
    missing = [f"{where}.{key}: {path} is not a file" for key, path in paths.items() if not path.is_file()]
    if missing:
        yield from missing
        return
    need_attention = set_name != "generation"
    problems = check_table(paths["trials"], paths["objects"], words=experiment.words, need_attention=need_attention)
    if problems or set_name != "train":
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
