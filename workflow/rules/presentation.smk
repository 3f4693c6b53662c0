"""What people look at: tables and figures."""

from dataclasses import replace

from evaluation.captions import caption, titled
from evaluation.catalogue import FIT_FIGURES, TABLE_FORMS, tables_of
from workflow.versions import pinned_packages, python_version, study_hash
from workflow.settings import portable

TABLES = tables_of(
    {
        (name, task, condition.D)
        for name in study.experiments
        for task in TASKS
        for condition in study.task_conditions(name, task)
    }
    | {(name, "csl", D) for name, experiment in study.experiments.items() for D in experiment.settings["D"]}
)


def largest_D(wildcards):
    """The largest D of an experiment, which its figure of the features shows."""
    return max(settings(wildcards)["D"])


def first_block(wildcards):
    """The first training trials, whose images a figure shows."""
    return study.trials(wildcards.experiment, "train")[:10]


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


def config_name():
    """The config file as `make` is told of it; of one that is elsewhere the name only."""
    path, root = CONFIG_FILE.resolve(), Path(workflow.basedir).resolve()
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name


def report_tables():
    """The tables of the report by file name, with their titles."""
    return {name: table.title for name, table in TABLES.items()}


def figure_labels(name):
    """How Snakemake's own report lists a figure."""
    title, figure = titled(name, study.experiments)
    return {"figure": title, "shows": caption(figure)}


# Each input is flagged for Snakemake's own report as well, in one place for all of them.
rule report:
    input:
        scores=report("scores.csv", caption="../report/scores.rst", category="Scores"),
        claims=[],  # the claims, and the comparisons behind them
        tables=[
            report(
                f"tables/{name}.html",
                caption="../report/table.rst",
                category="Tables",
                labels={"table": title},
            )
            for name, title in report_tables().items()
        ],
        figures=[
            report(
                f"figures/{name}.png", caption="../report/figure.rst", category="Figures", labels=figure_labels(name)
            )
            for name in figures()
        ],
        diagnostics=[
            f"diagnostics/{name}_D{D}.csv"
            for name in study.experiments
            for D in study.experiments[name].settings["D"]
        ],
    output:
        report("report.html", caption="../report/report.rst", category="Report"),
    log:
        "joblogs/report.log",
    params:
        config=config_name(),
        experiments={name: portable(experiment) for name, experiment in study.experiments.items()},
        python=python_version(),
        packages=pinned_packages(),
        hashes={"code": study_hash(), "environment.lock": lock_hash()},
        code=tracked("report.py"),
    script:
        "../scripts/report.py"
