"""What the rules ask of the plan: functions of inputs, outputs and parameters, a part for each rule file."""

from dataclasses import replace
from evaluation.captions import caption, titled
from evaluation.catalogue import CATEGORY_FIGURES, FIGURES, FIT_FIGURES, TABLE_FORMS, files_of_tables, tables_of
from workflow.settings import portable
from workflow.versions import pinned_packages, python_version, study_hash

# data_collection.smk


def simulated_blocks():
    """Each block of trials that one job simulates: (experiment, set, trials)."""
    for name, experiment in study.experiments.items():
        if experiment.source == "simulation" and experiment.data == name:
            for set_name in SETS:
                for trials in study.blocks(name, set_name):
                    yield name, set_name, trials


def log_path(experiment, set_name, trial):
    """Where the log of a trial is: in the results, or where the config says."""
    if study.experiments[experiment].source == "logs":
        return str(study.log_folder(experiment) / set_name / f"trial_{trial:04}.mcap")
    return f"mcap/{experiment}/{set_name}/trial_{trial:04}.mcap"


def calibration_path(wildcards):
    """Where the log of an experiment's camera calibration is."""
    if study.experiments[wildcards.experiment].source == "logs":
        return str(study.log_folder(wildcards.experiment) / "calibration.mcap")
    return "mcap/{experiment}/calibration.mcap"


# features.smk


def percept_paths(experiment, set_name, D=None):
    """The percepts of a set; of training trials the blocks that hold the first D."""
    return [
        f"percepts/{experiment}/{set_name}_{block[0]:04}-{block[-1]:04}.npz"
        for block in study.blocks(experiment, set_name)
        if D is None or block[0] <= int(D)
    ]


def logs_of_block(wildcards):
    """The logs of the block of trials that a path names."""
    first, last = (int(number) for number in wildcards.block.split("-"))
    return [log_path(wildcards.experiment, wildcards.set, trial) for trial in range(first, last + 1)]


def weights_file(wildcards):
    """The file of the network's weights as an input, where a config names one."""
    weights = study.weights_file(wildcards.experiment)
    return {"weights": str(weights)} if weights else {}


def extraction(wildcards):
    """The settings of feature extraction, in which a file of weights is called `file`: its content counts."""
    replaced = {"weights": "file"} if weights_file(wildcards) else {}
    return settings(wildcards).get("feature_extraction", {}) | replaced


# model.smk


def table_files(set_name):
    """A function that gives the feature table of a set: an experiment's own, or that of whose data it shares."""

    def of(wildcards):
        data = study.experiments[wildcards.experiment].data
        return {kind: f"features/{data}/D{wildcards.D}/{set_name}_{kind}.parquet" for kind in ("trials", "objects")}

    return of


# evaluation.smk


def columns(conditions):
    """The columns of scores.csv that name each of these fits."""
    return [
        vars(condition)
        | {
            "averaged_draws": averaged_draws(condition.inference),
            "chains": study.experiments[condition.experiment].settings["chains"],
        }
        for condition in conditions
    ]


def tested(wildcards, task):
    """The fits of an experiment and D that a task tests; for learning itself all."""
    conditions = study.conditions if task == "csl" else lambda experiment: study.task_conditions(experiment, task)
    return [condition for condition in conditions(wildcards.experiment) if condition.D == int(wildcards.D)]


def score_files():
    """The score file of each experiment, D and task that has something to test."""
    for name, experiment in study.experiments.items():
        for D in experiment.settings["D"]:
            yield f"scores/{name}_D{D}_csl.csv"
            for task in TASKS:
                if any(condition.D == D for condition in study.task_conditions(name, task)):
                    yield f"scores/{name}_D{D}_{task}.csv"


def chains_of(wildcards):
    """The chains that have one posterior: for each condition in which all words, or none, are heard, its seeds' fits."""
    chains = {}
    for condition in tested(wildcards, "csl"):
        if condition.ROW in (0, 100):
            names = vars(condition) | {"seed": None}
            chains.setdefault(tuple((key, value) for key, value in names.items() if key != "seed"), []).append(
                condition.path
            )
    return [(dict(names), paths) for names, paths in chains.items()]


# tasks.smk

GENERATION_PATH = FIT_PATH.replace("fits/", "generation/", 1).removesuffix(".npz")


def simulation_of(experiment):
    """The settings of the simulation that an experiment's data come from; None where they do not."""
    own = study.experiments[experiment]
    return own.settings.get("simulation", {}) if own.source == "simulation" else None


def scene_files(wildcards):
    """What it takes to carry out an answer in the simulated scenes; nothing where data are not simulated."""
    data = study.experiments[wildcards.experiment].data
    if simulation_of(data) is None:
        return {}
    return {
        "transforms": f"features/{data}/D{wildcards.D}/transforms.npz",
        "percepts": percept_paths(data, "generation"),
    }


# presentation.smk

TABLES = tables_of(
    {
        (name, task, condition.D)
        for name in study.experiments
        for task in TASKS
        for condition in study.task_conditions(name, task)
    }
    | {(name, "csl", D) for name, experiment in study.experiments.items() for D in experiment.settings["D"]},
    {name: experiment.partial_variants for name, experiment in study.experiments.items()},
)


# The experiments with instructions to answer.
INSTRUCTED = [name for name in study.experiments if study.generation_condition(name)]


def instructed_fits(wildcards):
    """The fits, one a seed, that figures of action generation show."""
    return study.seeds(study.generation_condition(wildcards.experiment))


def largest_D(wildcards):
    """The largest D of an experiment, which its figure of the features shows."""
    return max(settings(wildcards)["D"])


def first_block(wildcards):
    """The first training trials, whose images a figure shows."""
    return study.trials(wildcards.experiment, "train")[:10]


def described(experiment):
    """The files of what the robot said of its actions in an experiment; none where the study has no such test."""
    conditions = study.task_conditions(experiment, "description") if experiment in study.experiments else []
    return [f"descriptions/{experiment}_D{D}.csv" for D in sorted({condition.D for condition in conditions})]


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
    return [f"figures/{{experiment}}_{figure}.{form}" for form in FIGURES[figure].forms]


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
        if acts(name) and experiment.settings["generation"]["rated"] > 0:
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
        extraction = experiment.settings.get("feature_extraction", {})
        if experiment.data == name and extraction.get("detection", {}).get("on_wrong_count") == "drop":
            used = {"train": experiment.settings["D"]}
            used |= {task: [condition.D for condition in study.task_conditions(name, task)] for task in TASKS}
            for set_name, Ds in used.items():
                if Ds:
                    yield f"{name}, {set_name}", f"features/{name}/D{max(Ds)}/{set_name}_trials.parquet"


def figure_labels(name):
    """How Snakemake's own report lists a figure."""
    title, figure = titled(name, study.experiments)
    return {"figure": title, "shows": caption(figure)}
