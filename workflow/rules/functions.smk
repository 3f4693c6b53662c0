"""What the rules ask of the plan: functions of inputs, outputs and parameters, a part for each rule file."""


def plain(settings):
    """Settings as plain data, defaults included: so they stand in parameters and keys."""
    return settings.model_dump(mode="json")


# data_collection.smk


def simulation_of(experiment):
    """The settings of the simulation that an experiment's data come from; None where they do not."""
    own = study.experiments[experiment]
    return plain(own.settings.simulation) if own.source == "simulation" else None


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
        return str(study.log_folder(experiment) / set_name / file_of_trial(trial))
    return f"mcap/{experiment}/{set_name}/{file_of_trial(trial)}"


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
    return plain(settings(wildcards).feature_extraction) | replaced


def own_tables(wildcards):
    """The files of a feature table of one's own: of a folder, all its parts."""
    files = feature_files(study, wildcards.experiment, wildcards.set)
    return {
        key: [str(part) for part in parts_of(path)] if path.is_dir() else str(path) for key, path in files.items()
    }


def own_part_names(wildcards):
    """The names of a folder's parts, which may tell of values (`trial=3/`) that are not in the files."""
    folders = {
        key: path for key, path in feature_files(study, wildcards.experiment, wildcards.set).items() if path.is_dir()
    }
    return {key: [part.relative_to(path).as_posix() for part in parts_of(path)] for key, path in folders.items()}


# model.smk


def table_files(set_name):
    """A function that gives the feature table of a set: an experiment's own, or that of whose data it shares."""

    def of(wildcards):
        data = study.experiments[wildcards.experiment].data
        return {kind: f"features/{data}/D{wildcards.D}/{set_name}_{kind}.parquet" for kind in ("trials", "objects")}

    return of


def priors_of(wildcards):
    """The hyperparameters of a variant by channel."""
    priors = study.experiments[wildcards.experiment].priors(wildcards.variant)
    return {channel: plain(prior) for channel, prior in priors.items()}


# evaluation.smk


def names_of(conditions):
    """What names each of these fits in tables."""
    return [vars(condition) for condition in conditions]


def tested(wildcards, task):
    """The fits of an experiment and D that a task tests; for learning itself all."""
    conditions = study.conditions if task == "csl" else lambda experiment: study.task_conditions(experiment, task)
    return [condition for condition in conditions(wildcards.experiment) if condition.D == int(wildcards.D)]


def score_files():
    """The score file of each experiment, D and task that has something to test."""
    for name, experiment in study.experiments.items():
        for D in experiment.settings.D:
            yield f"scores/{name}_D{D}_csl.csv"
            for task in TASKS:
                if D in study.tested_D(name, task):
                    yield f"scores/{name}_D{D}_{task}.csv"


def chains_of(wildcards):
    """The chains of each condition: its names, without the seed, and the fits that have one posterior."""
    return [
        ({key: value for key, value in vars(condition).items() if key != "seed"}, study.chains(condition))
        for condition in tested(wildcards, "csl")
        if condition.seed == 1
    ]


def diagnosed():
    """Each experiment and D, as the names of the files of its chains have it."""
    for name in study.experiments:
        for D in dict.fromkeys(condition.D for condition in study.conditions(name)):
            yield f"{name}_D{D}"


# tasks.smk

GENERATION_PATH = FIT_PATH.replace("fits/", "generation/", 1).removesuffix(".npz")


def scene_files(wildcards):
    """What it takes to carry out an answer in the simulated scenes; nothing where data are not simulated."""
    data = study.experiments[wildcards.experiment].data
    if simulation_of(data) is None:
        return {}
    return {
        "transforms": f"features/{data}/D{wildcards.D}/transforms.npz",
        "percepts": percept_paths(data, "generation"),
    }
