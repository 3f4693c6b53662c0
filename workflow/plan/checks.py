"""What no single key of a config shows: contradictions between keys, and what the data themselves forbid."""

from __future__ import annotations

from collections.abc import Iterator

from data_collection.log.numbering import file_of_trial
from model.methods import METHODS
from model.samplers import SAMPLERS
from workflow.plan.config_types import CHANNELS, WORDLESS
from workflow.plan.experiment import TASKS, Experiment, log_folder_trials
from workflow.plan.own_tables import braces, named_by, table_problems
from workflow.plan.problems import key_path
from workflow.plan.study import Study
from workflow.plan.study_config import ExperimentConfig, StudyConfig, completed

MAX_FITS = 100_000
"""Fits, and jobs that simulate, of one experiment."""
# Keys that say nothing where the data come from elsewhere.
USELESS_WITH = {
    "datasets": ("features", "logs", "data"),
    "trials": ("features", "logs", "data"),
    "trials_per_job": ("features", "data"),
    "feature_extraction": ("features", "data"),
}
# The key of an experiment that says what may be named, where it is called otherwise.
SOURCES = {"variant": "variants", "method": "methods", "sampler": "samplers"}


def contradictions(name: str, config: StudyConfig) -> Iterator[str]:
    """What no single key shows: keys that exclude each other, words in two channels, references to nothing."""
    experiments = config.experiments
    own, where = experiments[name], key_path(["experiments", name])
    given = own.model_fields_set
    sources = [key for key in ("features", "logs", "data", "simulation") if key in given]
    if len(sources) > 1:
        yield f"{where}: {' and '.join(sources)} exclude each other: data have one source"
    for key, sources_without in USELESS_WITH.items():
        for source in sources_without:
            if key in given and source in given:
                yield f"{where}.{key}: has no effect with {source} (remove it)"
    owner = own.data or name
    if owner not in experiments or own.data == name:
        others = ", ".join(sorted(set(experiments) - {name})) or "there is none"
        yield f"{where}.data: {owner!r} is no other experiment (allowed: {others})"
        return
    if owner != name and (further := experiments[owner].data):
        yield f"{where}.data: {owner} has no data of its own but shares those of {further}"
    settings = completed(config, name)
    for other in sorted(experiments):
        if other < name and other.lower() == name.lower():
            yield f"{where}: differs from experiments.{other} only in capitals, which some disks do not tell apart"
    for key, names in (("variants", sorted(settings.variants)), ("samplers", sorted(settings.samplers))):
        for i, one in enumerate(names):
            for other in names[:i]:
                if other.lower() == one.lower():
                    yield f"{where}.{key}.{one}: differs from {other} only in capitals"
    words = own.words or experiments[owner].words
    if words is None:
        yield f"{where}: key 'words' is missing (the words by channel: the true channel of each word)"
        return
    for method in settings.methods:
        if not any(sampler.takes(METHODS[method]) for sampler in settings.samplers.values()):
            kinds = ", ".join(kind for kind, sampler in SAMPLERS.items() if sampler().takes(METHODS[method]))
            yield f"{where}: no sampler can fit method {method} (add one of kind {kinds})"
    for i, channel in enumerate(CHANNELS):
        for other in CHANNELS[i + 1 :]:
            for word in sorted(set(getattr(words, channel)) & set(getattr(words, other))):
                yield f"{where}.words: {word!r} is a word of {channel} and of {other} (allowed: one channel per word)"
    yield from _implausible_counts(where, own)
    yield from _tests_without_effect(where, own)
    yield from _conditions_not_run(where, settings)
    trials = experiments[owner].trials
    for i, D in enumerate(own.D):
        if trials is not None and D > trials:
            yield f"{where}.D[{i}]: {D} is more than the {trials} trials collected (experiments.{owner}.trials)"


def _implausible_counts(where: str, own: ExperimentConfig) -> Iterator[str]:
    """Numbers of objects that are simulated, but that would stop the run when they are seen."""
    simulated, detection = own.simulation, own.feature_extraction.detection
    elsewhere = {"features", "logs", "data"} & own.model_fields_set
    if elsewhere or detection.on_wrong_count != "error":
        return
    place = f"{where}.feature_extraction.detection"
    if "most_objects" in detection.model_fields_set and detection.most_objects < simulated.objects_most:
        yield (
            f"{place}.most_objects: {detection.most_objects} is less than the {simulated.objects_most} objects that "
            f"are simulated ({where}.simulation.objects_most)"
        )
    if detection.fewest_objects > simulated.objects_least:
        yield (
            f"{place}.fewest_objects: {detection.fewest_objects} is more than the {simulated.objects_least} objects "
            f"that are simulated ({where}.simulation.objects_least)"
        )


def _tests_without_effect(where: str, own: ExperimentConfig) -> Iterator[str]:
    """Numbers of test trials, which are simulated, where the data come from elsewhere."""
    for task, key in TASKS.items():
        asked = getattr(own, task)
        for source in ("features", "logs", "data"):
            if key in asked.model_fields_set and getattr(asked, key) and source in own.model_fields_set:
                yield f"{where}.{task}.{key}: with {source}, whose own trials test, only 0 has an effect (no test)"


def _conditions_not_run(where: str, settings: ExperimentConfig) -> Iterator[str]:
    """Conditions that tasks, variants or the figure name, but that the experiment does not have."""
    methods, samplers = list(settings.methods), list(settings.samplers)
    available = {
        "D": settings.D,
        "ROW": settings.ROW,
        "variant": list(settings.variants),
        "method": methods,
        "methods": [*methods, *(set(WORDLESS) - set(methods))],
        "sampler": samplers,
        "samplers": samplers,
    }
    naming = {task: getattr(settings, task) for task in TASKS} | {"figure": settings.figure}
    naming |= {f"variants.{name}.only": variant.only for name, variant in settings.variants.items()}
    for place, naming_model in naming.items():
        asked = naming_model.model_dump(exclude_unset=True)
        for key in [key for key in available if key in asked]:
            listed = isinstance(asked[key], tuple)
            for i, value in enumerate(asked[key] if listed else [asked[key]]):
                if value not in available[key]:
                    allowed = ", ".join(map(str, available[key]))
                    yield (
                        f"{where}.{place}.{key}{f'[{i}]' if listed else ''}: {value} is not run "
                        f"(allowed: {allowed}, from {where}.{SOURCES.get(key, key)})"
                    )


def size_problems(study: Study, name: str) -> Iterator[str]:
    """More jobs than anybody means."""
    if (count := sum(map(study.size, study.sets(name)))) > MAX_FITS:
        yield (
            f"{key_path(['experiments', name])}: asks for {count:,} fits and parts of a simulation; at most "
            f"{MAX_FITS:,} are run (fewer data sets, seeds, D or variants)"
        )


def grid_problems(study: Study, name: str) -> Iterator[str]:
    """What an experiment's variants leave without a fit."""
    where = key_path(["experiments", name])
    run = list(study.conditions(name))
    for i, D in enumerate(study.experiments[name].settings.D):
        if not any(condition.D == D for condition in run):
            yield f"{where}.D[{i}]: {D} is run for no variant (see {where}.variants)"
    hears = any(condition.method not in WORDLESS for condition in run)
    for task, key in TASKS.items():
        if hears and study.is_tested(name, task) and not study.task_conditions(name, task):
            asked = study.experiments[name].task(task)
            grid = f"D {', '.join(map(str, asked.D))} and ROW {', '.join(map(str, asked.ROW))}"
            yield f"{where}.{task}: no fit is run with {grid} (see {where}.variants; {key}: 0 leaves the task out)"
    if None in study.figure_conditions(name).values():
        figure = study.experiments[name].settings.figure.model_dump(exclude_unset=True)
        figure |= {"samplers": ", ".join(figure["samplers"])} if "samplers" in figure else {}
        shown = ", ".join(f"{key} {value}" for key, value in figure.items())
        allowed = dict.fromkeys(f"{c.variant} {c.method} {c.sampler} D {c.D} ROW {c.ROW}" for c in run)
        yield f"{where}.figure: no fit has {shown} (allowed: {'; '.join(allowed)})"


def data_problems(study: Study, name: str, notes: list[str]) -> Iterator[str]:
    """What the data themselves forbid: settings of the simulation, files of one's own of a data set.

    Args:
        study: The plan.
        name: A data set of an experiment.
        notes: Gets what a reader should know, but what forbids nothing.
    """
    experiment = study.experiments[name]
    where = key_path(["experiments", experiment.title])
    if experiment.data != name:
        return
    first = experiment.dataset == 1  # what is the same for all of them is told once
    if first and experiment.source != "features" and (weights := study.weights_file(name)):
        yield from braces(f"{where}.feature_extraction.weights", weights)
        if not weights.is_file():
            yield f"{where}.feature_extraction.weights: {weights} is not a file (nor seeded, nor imagenet1k)"
    if first and experiment.source == "simulation":
        said = experiment.settings.simulation.check_words(experiment.words)
        yield from (f"{where}.simulation: {line}" for line in said)
    if experiment.source == "logs":
        yield from _log_problems(study, experiment)
    if experiment.source == "features":
        for set_name in ("train", *TASKS):
            if study.trials(name, set_name):
                yield from table_problems(study, experiment, set_name, notes)


def too_long(study: Study, experiment: Experiment, words: int) -> str:
    """Say why a sentence of so many words is too long for what is fitted to a data set; empty if it is not."""
    users = [user for user in study.experiments.values() if user.data == experiment.name]
    methods = [name for user in users for name in user.settings.methods]
    for name in methods:
        if words > METHODS[name].frame_prior.word_limit(len(CHANNELS)):
            return f"{words} words, but method {name} explains at most {len(CHANNELS)} (one per channel)"
    return ""


def _log_problems(study: Study, experiment: Experiment) -> Iterator[str]:
    where = key_path(named_by(experiment, "logs"))
    folder = study.log_folder(experiment.name)
    yield from braces(where, folder)
    if not (folder / "calibration.mcap").is_file():
        yield f"{where}: {folder / 'calibration.mcap'} is not a file (the log of the camera's calibration)"
    count = len(log_folder_trials(folder, "train"))
    needed = max(D for user in study.experiments.values() if user.data == experiment.name for D in user.settings.D)
    if count < needed:
        others = sorted(path.name for path in (folder / "train").glob("*.mcap*"))[count:]
        there = f"; there are also {', '.join(others[:3])}{', …' if len(others) > 3 else ''}" if others else ""
        yield (
            f"{where}: D is up to {needed}, but {folder / 'train'} holds {count} logs numbered without a gap "
            f"({file_of_trial(1)}, {file_of_trial(2)}, …){there}"
        )
