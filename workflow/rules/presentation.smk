"""What people look at: tables and figures."""

from dataclasses import replace

from evaluation.captions import caption, titled
from evaluation.catalogue import FIT_FIGURES, TABLE_FORMS, files_of_tables, tables_of
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

# The experiments with instructions to answer.
INSTRUCTED = [name for name in study.experiments if study.task_conditions(name, "generation")]


def instructed_fits(wildcards):
    """The fits, one a seed, that figures of action generation show: most trials, fewest words omitted, first method."""
    tested = study.task_conditions(wildcards.experiment, "generation")
    first = min(tested, key=lambda condition: (-condition.D, condition.ROW))
    return [condition for condition in tested if replace(condition, seed=first.seed) == first]


def instructed_tables(wildcards):
    """The feature tables of the instructions that those fits answer."""
    return table_files("generation")(instructed_fits(wildcards)[0])


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
        expand("tables/{file}", file=files_of_tables(TABLES)),
    log:
        "joblogs/tables.log",
    params:
        tables=TABLES,
        code=tracked("tables.py"),
    script:
        "../scripts/tables.py"


def described(experiment):
    """The files of what the robot said of its actions in an experiment; none where the study has no such test."""
    conditions = study.task_conditions(experiment, "description") if experiment in study.experiments else []
    return [f"descriptions/{experiment}_D{D}.csv" for D in sorted({condition.D for condition in conditions})]


rule claims:
    input:
        scores="scores.csv",
        descriptions=described("simulator"),
    output:
        claims="claims.csv",
        comparisons="claims_comparisons.csv",
        page="claims.html",
    log:
        "joblogs/claims.log",
    params:
        code=tracked("claims.py"),
    script:
        "../scripts/claims.py"


def figures():
    """The figures of a study: of the fits, of the features where there are logs, of what was simulated."""
    for name, experiment in study.experiments.items():
        yield from (f"{name}_{figure}" for figure in FIT_FIGURES)
        if experiment.data == name and experiment.source != "features":
            yield f"{name}_features"
        if experiment.data == name and experiment.source == "simulation":
            yield from (f"{name}_trials", f"{name}_objects")
        if name in INSTRUCTED:
            yield from (f"{name}_instructions", f"{name}_uncertain")


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


rule figure_of_instructions:
    input:
        unpack(instructed_tables),
        fits=lambda wildcards: [condition.path for condition in instructed_fits(wildcards)],
    output:
        "figures/{experiment}_instructions.png",
        "figures/{experiment}_instructions.pdf",
    log:
        "joblogs/figures/{experiment}_instructions.log",
    params:
        condition=lambda wildcards: vars(instructed_fits(wildcards)[0]),
        code=tracked("figure_of_instructions.py"),
    script:
        "../scripts/figure_of_instructions.py"


rule present_uncertain:
    input:
        lambda wildcards: [
            f"uncertain/{wildcards.experiment}_D{D}.csv"
            for D in settings(wildcards)["D"]
            if D in settings(wildcards)["generation"]["D"]
        ],
    output:
        **{form: f"tables/{{experiment}}_uncertain.{form}" for form in TABLE_FORMS},
        **{form: f"figures/{{experiment}}_uncertain.{form}" for form in ("png", "pdf")},
    log:
        "joblogs/figures/{experiment}_uncertain.log",
    params:
        condition=lambda wildcards: vars(instructed_fits(wildcards)[0]),
        code=tracked("present_uncertain.py"),
    script:
        "../scripts/present_uncertain.py"
def config_name():
    """The config file as `make` is told of it; of one that is elsewhere the name only."""
    path, root = CONFIG_FILE.resolve(), Path(workflow.basedir).resolve()
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name


def report_tables():
    """The tables of the report by file name, with their titles."""
    uncertain = {f"{name}_uncertain": f"Uncertain instructions, {name}" for name in INSTRUCTED}
    return {name: table.title for name, table in TABLES.items()} | uncertain


def figure_labels(name):
    """How Snakemake's own report lists a figure."""
    title, figure = titled(name, study.experiments)
    return {"figure": title, "shows": caption(figure)}


# Each input is flagged for Snakemake's own report as well, in one place for all of them.
rule report:
    input:
        scores=report("scores.csv", caption="../report/scores.rst", category="Scores"),
        claims=[
            report("claims.csv", caption="../report/claims.rst", category="Claims"),
            "claims_comparisons.csv",
        ],
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
