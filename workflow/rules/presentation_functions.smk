"""What the rules of presentation.smk ask of the plan: tables, figures, clips to rate, the report."""

from dataclasses import replace
from evaluation.catalogue import files_of_tables, tables_of
from evaluation.claims.shades import is_figure_8
from evaluation.figures.catalogue import FIGURES, shown_figure
from model import METHODS
from workflow.artifacts.versions import pinned_packages, python_version, study_hash
from workflow.plan.all_settings import all_settings, source_in_words

# The experiments with instructions to answer.
INSTRUCTED = [name for name in study.first_sets if study.generation_condition(name)]

TABLES = tables_of(
    {(name, task, D) for name in study.first_sets for task in TASKS for D in study.tested_D(name, task)}
    | {(name, "uncertain", D) for name in INSTRUCTED for D in study.tested_D(name, "generation")}
    | {(name, "csl", D) for name, experiment in study.first_sets.items() for D in experiment.settings.D},
    {name: experiment.partial_variants for name, experiment in study.first_sets.items()},
)


def tested_files(sets, task, path):
    """A file of each of some data sets and of each D that a task tests; none where the study has no such test."""
    return [path.format(experiment=name, D=D) for name in sets for D in study.tested_D(name, task)]


def uncertain_files(sets):
    """The answers to uncertain instructions."""
    return tested_files(sets, "generation", "uncertain/{experiment}_D{D}.csv")


def answer_files(condition):
    """What a fit answered, and the logs of what it did."""
    folder = GENERATION_PATH.format(**condition.wildcards)
    return {"answers": f"{folder}/answers.csv", "logs": f"{folder}/mcap"}


def acts(name):
    """Whether instructions of an experiment are carried out, so that there is something to show."""
    return name in INSTRUCTED and simulation_of(study.experiments[name].data) is not None


# Figures: of an experiment, the inputs by name and the settings that a kind of figure is drawn from; None without.
# What shows a fit is told whose, by the ending of its name, see `Study.figure_conditions`.


def shown_fit(condition):
    """The fits, one per seed, of the condition that a figure shows."""
    return {"fits": [one.path for one in study.seeds(condition)]}, {"condition": vars(condition)}


def fit_inputs(name, sampler):
    files, shown = shown_fit(study.figure_conditions(name)[sampler])
    return files, shown | {"words": study.experiments[name].words}


def crop_inputs(name, sampler):
    data, condition = study.experiments[name].data, study.figure_conditions(name)[sampler]
    if study.experiments[data].source == "features":
        return None
    files, shown = shown_fit(condition)
    return files | {"percepts": percept_paths(data, "train", condition.D)}, shown


def scores_over(name, setting):
    """All scores, for curves over D or ROW, of the first variant that has several; None without."""
    for variant in study.experiments[name].settings.variants:
        own = [one for one in study.conditions(name) if one.variant == variant and METHODS[one.method].hears_words]
        if len({getattr(one, setting) for one in own}) > 1:
            return {"scores": ["scores.csv"]}, {"variant": variant}
    return None


def description_inputs(name):
    counts = tested_files([name], "description", "confusion/{experiment}_D{D}.csv")
    return ({"counts": counts}, {"words": study.experiments[name].words}) if counts else None


def execution_inputs(name):
    if not acts(name):
        return None
    files, shown = shown_fit(study.generation_condition(name))
    answered = [answer_files(one) for one in study.seeds(study.generation_condition(name))]
    return files | {key: [one[key] for one in answered] for key in ("answers", "logs")}, shown


def instruction_inputs(name):
    if name not in INSTRUCTED:
        return None
    condition = study.generation_condition(name)
    files, shown = shown_fit(condition)
    return files | {key: [path] for key, path in table_files("generation")(condition).items()}, shown


def uncertain_inputs(name):
    if name not in INSTRUCTED:
        return None
    return {"answers": uncertain_files([name])}, {"condition": vars(study.generation_condition(name))}


def feature_inputs(name):
    experiment = study.experiments[name]
    if experiment.data != name or experiment.source == "features":
        return None
    D, trials = max(experiment.settings.D), study.trials(name, "train")[:10]
    tables = {key: f"train_{key}.parquet" for key in ("trials", "objects")} | {"transforms": "transforms.npz"}
    files = {key: [f"features/{name}/D{D}/{file}"] for key, file in tables.items()}
    files["percepts"] = percept_paths(name, "train", D)
    files["logs"] = [log_path(name, "train", trial) for trial in trials]
    return files, {"D": D, "trials": list(trials), "groups": len(experiment.words["object"])}


def trial_inputs(name):
    if simulation_inputs(name) is None:  # an experiment that shares the data of another has no trials of its own
        return None
    return {"logs": [log_path(name, "train", trial) for trial in study.trials(name, "train")[:12]]}, {}


def simulation_inputs(name):
    simulated = study.experiments[name].data == name and simulation_of(name) is not None
    return ({}, {"simulation": simulation_of(name)}) if simulated else None


FIGURE_INPUTS = {
    "fit": fit_inputs,
    "fit and crops": crop_inputs,
    "scores over ROW": lambda name: scores_over(name, "ROW"),
    "scores over D": lambda name: scores_over(name, "D"),
    "descriptions": description_inputs,
    "executed answers": execution_inputs,
    "instructions": instruction_inputs,
    "uncertain answers": uncertain_inputs,
    "features": feature_inputs,
    "simulated trials": trial_inputs,
    "simulation": simulation_inputs,
}
# What is drawn of data alone runs in the Slurm jobs that make them; what is drawn of no file would be a job by itself.
DATA_INPUTS = {"features", "simulated trials"}


def figure_inputs(kind, experiment, sampler=None):
    """The inputs of a figure; of one that shows the fit of a sampler, for this one."""
    return FIGURE_INPUTS[kind](experiment, *([] if sampler is None else [sampler]))


def shown_by(wildcards):
    """The experiment of a figure and, where there is one, its sampler."""
    return wildcards.experiment, wildcards.get("sampler")


def figures_of_study():
    """Each figure of the study: its name in the catalogue, and the experiment, method and sampler that it shows.

    All are of the first data set.
    """
    for experiment in study.first_sets:
        described = dict.fromkeys(one.method for one in study.task_conditions(experiment, "description"))
        for name, figure in FIGURES.items():
            samplers = study.figure_conditions(experiment) if "{sampler}" in name else [None]
            for sampler in samplers:
                if figure_inputs(figure.inputs, experiment, sampler) is not None:
                    for method in described if "{method}" in name else [""]:
                        yield name, experiment, method, sampler or ""


SHOWN_FIGURES = list(figures_of_study())


def figure_files():
    """All files of all figures."""
    for name, experiment, method, sampler in SHOWN_FIGURES:
        for form in FIGURES[name].forms:
            yield f"figures/{experiment}_{name}.{form}".format(method=method, sampler=sampler)


def told_figure(name, experiment, *names):
    """A figure as pages show it; of an experiment of several data sets it says that it shows the first."""
    figure, sets = shown_figure(name, experiment, *names), len(study.sets(experiment))
    return replace(figure, caption=f"{figure.caption} Data set 1 of {sets}.") if sets > 1 else figure


def rated(name):
    """Of each condition whose actions people may rate, all seeds: their names, and where fit, answers and logs are."""
    groups = {}
    for condition in study.task_conditions(name, "generation"):
        one = {"names": vars(condition), "fit": condition.path} | answer_files(condition)
        groups.setdefault(replace(condition, seed=0), []).append(one)
    return list(groups.values())


def rating_keys():
    """The key to each experiment's clips, which are of its first data set."""
    for name, experiment in study.first_sets.items():
        if acts(name) and experiment.settings.generation.rated > 0:
            yield f"ratings/{name}_key.csv"


def config_name():
    """The config file as `make` is told of it; of one that is elsewhere the name only."""
    path, root = CONFIG_FILE.resolve(), Path(workflow.basedir).resolve()
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name


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


def tried():
    """Each simulated set of actions to tell about: its experiment, and its feature table at the largest D."""
    for name, experiment in study.experiments.items():
        if experiment.data == name and experiment.source == "simulation":
            if Ds := study.tested_D(name, "description"):
                yield experiment.title, f"features/{name}/D{max(Ds)}/description_trials.parquet"


def shaded():
    """The fits of the paper's Figure 8, with all seeds, where the shades of objects are known: those of simulations."""
    for name in study.sets("real"):
        simulation = study.experiments[study.experiments[name].data].settings.simulation
        for condition in study.figure_conditions(name).values():
            if is_figure_8(vars(condition)) and simulation_of(study.experiments[name].data):
                table = f"features/{study.experiments[name].data}/D{condition.D}/train_{{}}.parquet"
                yield {
                    "condition": vars(condition),
                    "fits": [one.path for one in study.seeds(condition)],
                    "trials": table.format("trials"),
                    "objects": table.format("objects"),
                    "shades": simulation.shades_by_words(),
                }
