"""Measures of learning, and the one file that holds the measures of everything."""


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
