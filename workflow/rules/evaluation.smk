"""Measures of the fits, tables and figures."""

from dataclasses import replace

from evaluation.catalogue import FIT_FIGURES, TABLE_FORMS, tables_of

TABLES = tables_of(
    {
        (name, task, condition.D)
        for name in study.experiments
        for task in TASKS
        for condition in study.task_conditions(name, task)
    }
    | {(name, "csl", D) for name, experiment in study.experiments.items() for D in experiment.settings["D"]}
)


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


def largest_D(wildcards):
    """The largest D of an experiment, which its figure of the features shows."""
    return max(settings(wildcards)["D"])


def first_block(wildcards):
    """The first training trials, whose images a figure shows."""
    return study.trials(wildcards.experiment, "train")[:10]


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


rule evaluate_learning:
    input:
        unpack(table_files("train")),
        fits=lambda wildcards: [condition.path for condition in tested(wildcards, "csl")],
    output:
        "scores/{experiment}_D{D}_csl.csv",
    log:
        "joblogs/evaluate/{experiment}_D{D}_csl.log",
    params:
        conditions=lambda wildcards: columns(tested(wildcards, "csl")),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("evaluate_learning.py"),
    script:
        "../scripts/evaluate_learning.py"


rule describe:
    input:
        unpack(table_files("description")),
        fits=lambda wildcards: [condition.path for condition in tested(wildcards, "description")],
    output:
        scores="scores/{experiment}_D{D}_description.csv",
        descriptions="descriptions/{experiment}_D{D}.csv",
    log:
        "joblogs/describe/{experiment}_D{D}.log",
    params:
        conditions=lambda wildcards: columns(tested(wildcards, "description")),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("describe.py"),
    script:
        "../scripts/describe.py"


rule generate:
    input:
        unpack(table_files("generation")),
        unpack(scene_files),
        fit=FIT_PATH,
    output:
        answers=f"{GENERATION_PATH}/answers.csv",
        logs=directory(f"{GENERATION_PATH}/mcap"),
    log:
        "joblogs/generate/{experiment}_{variant}_{method}_{inference}_D{D}_ROW{ROW}_seed{seed}.log",
    params:
        data=lambda wildcards: study.experiments[wildcards.experiment].data,
        simulation=lambda wildcards: simulation_of(study.experiments[wildcards.experiment].data),
        seed=lambda wildcards: settings(wildcards)["seed"],
        data_seed=lambda wildcards: study.experiments[study.experiments[wildcards.experiment].data].settings["seed"],
        code=tracked("generate.py"),
    script:
        "../scripts/generate.py"


rule evaluate_generation:
    input:
        lambda wildcards: [
            f"{GENERATION_PATH}/answers.csv".format(**vars(condition))
            for condition in tested(wildcards, "generation")
        ],
    output:
        "scores/{experiment}_D{D}_generation.csv",
    log:
        "joblogs/evaluate/{experiment}_D{D}_generation.log",
    params:
        conditions=lambda wildcards: columns(tested(wildcards, "generation")),
        code=tracked("evaluate_generation.py"),
    script:
        "../scripts/evaluate_generation.py"


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


rule diagnose:
    input:
        lambda wildcards: [path for _, paths in chains_of(wildcards) for path in paths],
    output:
        table="diagnostics/{experiment}_D{D}.csv",
        page="diagnostics/{experiment}_D{D}.html",
    log:
        "joblogs/diagnose/{experiment}_D{D}.log",
    params:
        conditions=chains_of,
        code=tracked("diagnose.py"),
    script:
        "../scripts/diagnose.py"


rule scores:
    input:
        list(score_files()),
    output:
        "scores.csv",
    log:
        "joblogs/scores.log",
    params:
        code=tracked("scores.py"),
    script:
        "../scripts/scores.py"


rule tables:
    input:
        "scores.csv",
    output:
        [f"tables/{name}.{form}" for name in TABLES for form in TABLE_FORMS],
    log:
        "joblogs/tables.log",
    params:
        tables=TABLES,
        code=tracked("tables.py"),
    script:
        "../scripts/tables.py"


def figures():
    """The figures of a study: of the fits, of the features where there are logs, of what was simulated."""
    for name, experiment in study.experiments.items():
        yield from (f"{name}_{figure}" for figure in FIT_FIGURES)
        if experiment.data == name and experiment.source != "features":
            yield f"{name}_features"
        if experiment.data == name and experiment.source == "simulation":
            yield from (f"{name}_trials", f"{name}_objects")


rule figure_of_features:
    input:
        percepts=lambda wildcards: percept_paths(wildcards.experiment, "train", largest_D(wildcards)),
        logs=lambda wildcards: [log_path(wildcards.experiment, "train", trial) for trial in first_block(wildcards)],
        trials=lambda wildcards: f"features/{wildcards.experiment}/D{largest_D(wildcards)}/train_trials.parquet",
        objects=lambda wildcards: f"features/{wildcards.experiment}/D{largest_D(wildcards)}/train_objects.parquet",
        transforms=lambda wildcards: f"features/{wildcards.experiment}/D{largest_D(wildcards)}/transforms.npz",
    output:
        "figures/{experiment}_features.png",
    log:
        "joblogs/figures/{experiment}_features.log",
    wildcard_constraints:
        experiment=sources("simulation", "logs"),
    params:
        D=lambda wildcards: largest_D(wildcards),
        trials=lambda wildcards: first_block(wildcards),
        groups=lambda wildcards: len(study.experiments[wildcards.experiment].words["object"]),
        code=tracked("figure_of_features.py"),
    script:
        "../scripts/figure_of_features.py"


rule figure_of_fit:
    input:
        fits=lambda wildcards: [
            replace(study.figure_condition(wildcards.experiment), seed=seed).path
            for seed in range(1, settings(wildcards)["seeds"] + 1)
        ],
    output:
        **{figure: f"figures/{{experiment}}_{figure}.png" for figure in FIT_FIGURES},
    log:
        "joblogs/figures/{experiment}.log",
    params:
        condition=lambda wildcards: vars(study.figure_condition(wildcards.experiment)),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("figure_of_fit.py"),
    script:
        "../scripts/figure_of_fit.py"
