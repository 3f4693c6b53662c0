"""What the rules of presentation.smk ask of the plan: tables, figures, clips to rate, the report."""

from dataclasses import replace
from evaluation.pages.captions import caption, titled
from evaluation.catalogue import CATEGORY_FIGURES, FIT_FIGURES, TABLE_FORMS, figure_of, files_of_tables, tables_of
from workflow.artifacts.versions import pinned_packages, python_version, study_hash
from workflow.plan.overview import overview, source_in_words

TABLES = tables_of(
    {(name, task, D) for name in study.experiments for task in TASKS for D in study.tested_D(name, task)}
    | {(name, "csl", D) for name, experiment in study.experiments.items() for D in experiment.settings.D},
    {name: experiment.partial_variants for name, experiment in study.experiments.items()},
)


# The experiments with instructions to answer.
INSTRUCTED = [name for name in study.experiments if study.generation_condition(name)]


def instructed_fits(wildcards):
    """The fits, one a seed, that figures of action generation show."""
    return study.seeds(study.generation_condition(wildcards.experiment))


def largest_D(wildcards):
    """The largest D of an experiment, which its figure of the features shows."""
    return max(settings(wildcards).D)


def first_block(wildcards):
    """The first training trials, whose images a figure shows."""
    return study.trials(wildcards.experiment, "train")[:10]


def described(experiment):
    """The files of what the robot said of its actions in an experiment; none where the study has no such test."""
    known = experiment in study.experiments
    return [f"descriptions/{experiment}_D{D}.csv" for D in study.tested_D(experiment, "description")] if known else []


def figures_of(name):
    """The figures of an experiment: its own features have no logs, and a robot's logs cannot be simulated further."""
    experiment = study.experiments[name]
    data = study.experiments[experiment.data]
    yield from FIT_FIGURES
    if data.source != "features":
        yield from CATEGORY_FIGURES
    yield from (f"confusion_{method}" for method in methods_described(name))
    if acts(name):
        yield from ("generation", "action")
    if name in INSTRUCTED:
        yield from ("instructions", "uncertain")
    if experiment is data and experiment.source != "features":
        yield "features"
    if experiment is data and experiment.source == "simulation":
        yield from ("trials", "objects")


def methods_described(name):
    """The methods that describe actions of an experiment."""
    return dict.fromkeys(condition.method for condition in study.task_conditions(name, "description"))


def acts(name):
    """Whether instructions of an experiment are carried out, so that there is something to show."""
    return simulation_of(study.experiments[name].data) is not None and study.generation_condition(name) is not None


def files_of(figure):
    """The files of one kind of figure, whose experiment is a wildcard."""
    return [f"figures/{{experiment}}_{figure}.{form}" for form in figure_of(figure).forms]


def figure_files():
    """All files of all figures."""
    for name in study.experiments:
        for figure in figures_of(name):
            yield from expand(files_of(figure), experiment=name)


def fits_shown(wildcards):
    """The fits, one a seed, of the condition that an experiment's figures of a fit show."""
    return [condition.path for condition in study.seeds(study.figure_condition(wildcards.experiment))]


def rated(name):
    """Of each condition whose actions people may rate, all seeds: their names, and where fit, answers and logs are."""
    groups = {}
    for condition in study.task_conditions(name, "generation"):
        one = {"names": columns([condition])[0], "fit": condition.path}
        one["answers"] = f"{GENERATION_PATH}/answers.csv".format(**vars(condition))
        one["logs"] = f"{GENERATION_PATH}/mcap".format(**vars(condition))
        groups.setdefault(replace(condition, seed=0), []).append(one)
    return list(groups.values())


def rating_keys():
    """The key to each experiment's clips."""
    for name, experiment in study.experiments.items():
        if acts(name) and experiment.settings.generation.rated > 0:
            yield f"ratings/{name}_key.csv"


def config_name():
    """The config file as `make` is told of it; of one that is elsewhere the name only."""
    path, root = CONFIG_FILE.resolve(), Path(workflow.basedir).resolve()
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name


def report_tables():
    """The tables of the report by file name, with their titles."""
    uncertain = {f"{name}_uncertain": f"Uncertain instructions, {name}" for name in INSTRUCTED}
    return {name: table.title for name, table in TABLES.items()} | uncertain


def droppable():
    """Each set of which trials may be dropped, by name, and its feature table at the largest D that is used."""
    for name, experiment in study.experiments.items():
        on_wrong_count = experiment.settings.feature_extraction.detection.on_wrong_count
        if experiment.data == name and on_wrong_count == "drop":
            used = {"train": experiment.settings.D}
            used |= {task: study.tested_D(name, task) for task in TASKS}
            for set_name, Ds in used.items():
                if Ds:
                    yield f"{name}, {set_name}", f"features/{name}/D{max(Ds)}/{set_name}_trials.parquet"


def figure_labels(name):
    """How Snakemake's own report lists a figure."""
    title, figure = titled(name, study.experiments)
    return {"figure": title, "shows": caption(figure)}
