"""What people look at: tables, figures, and clips to rate."""

from dataclasses import replace

from evaluation.captions import caption, titled
from evaluation.catalogue import CATEGORY_FIGURES, FIGURES, FIT_FIGURES, TABLE_FORMS, files_of_tables, tables_of
from workflow.versions import pinned_packages, python_version, study_hash
from workflow.settings import portable

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


rule figure_of_features:
    input:
        percepts=lambda wildcards: percept_paths(wildcards.experiment, "train", largest_D(wildcards)),
        logs=lambda wildcards: [log_path(wildcards.experiment, "train", trial) for trial in first_block(wildcards)],
        trials=lambda wildcards: f"features/{wildcards.experiment}/D{largest_D(wildcards)}/train_trials.parquet",
        objects=lambda wildcards: f"features/{wildcards.experiment}/D{largest_D(wildcards)}/train_objects.parquet",
        transforms=lambda wildcards: f"features/{wildcards.experiment}/D{largest_D(wildcards)}/transforms.npz",
    output:
        files_of("features"),
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
        fits=fits_shown,
    output:
        **{figure: files_of(figure) for figure in FIT_FIGURES},
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
        unpack(lambda wildcards: table_files("generation")(study.generation_condition(wildcards.experiment))),
        fits=lambda wildcards: [condition.path for condition in instructed_fits(wildcards)],
    output:
        files_of("instructions"),
    log:
        "joblogs/figures/{experiment}_instructions.log",
    params:
        condition=lambda wildcards: vars(study.generation_condition(wildcards.experiment)),
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
        condition=lambda wildcards: vars(study.generation_condition(wildcards.experiment)),
        code=tracked("present_uncertain.py"),
    script:
        "../scripts/present_uncertain.py"


rule figure_of_categories:
    input:
        fits=fits_shown,
        percepts=lambda wildcards: percept_paths(
            study.experiments[wildcards.experiment].data, "train", study.figure_condition(wildcards.experiment).D
        ),
    output:
        **{figure: files_of(figure) for figure in CATEGORY_FIGURES},
    log:
        "joblogs/figures/{experiment}_categories.log",
    params:
        condition=lambda wildcards: vars(study.figure_condition(wildcards.experiment)),
        code=tracked("figure_of_categories.py"),
    script:
        "../scripts/figure_of_categories.py"


rule count_confusions:
    input:
        "descriptions/{experiment}_D{D}.csv",
    output:
        "confusion/{experiment}_D{D}.csv",
    log:
        "joblogs/confusion/{experiment}_D{D}.log",
    params:
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("count_confusions.py"),
    script:
        "../scripts/count_confusions.py"


rule figure_of_confusion:
    input:
        lambda wildcards: [
            f"confusion/{wildcards.experiment}_D{D}.csv" for D in settings(wildcards)["description"]["D"]
        ],
    output:
        [path.replace("proposed", "{method}") for path in files_of("confusion_proposed")],
    log:
        "joblogs/figures/{experiment}_confusion_{method}.log",
    params:
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("figure_of_confusion.py"),
    script:
        "../scripts/figure_of_confusion.py"


rule figure_of_generation:
    input:
        fits=lambda wildcards: [condition.path for condition in instructed_fits(wildcards)],
        answers=lambda wildcards: [
            f"{GENERATION_PATH}/answers.csv".format(**vars(condition)) for condition in instructed_fits(wildcards)
        ],
        logs=lambda wildcards: [
            f"{GENERATION_PATH}/mcap".format(**vars(condition)) for condition in instructed_fits(wildcards)
        ],
    output:
        generation=files_of("generation"),
        action=files_of("action"),
    log:
        "joblogs/figures/{experiment}_generation.log",
    params:
        condition=lambda wildcards: vars(study.generation_condition(wildcards.experiment)),
        code=tracked("figure_of_generation.py"),
    script:
        "../scripts/figure_of_generation.py"


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


rule ratings:
    input:
        lambda wildcards: [
            one[kind]
            for seeds in rated(wildcards.experiment)
            for one in seeds
            for kind in ("fit", "answers", "logs")
        ],
    output:
        folder=directory("ratings/{experiment}"),
        key="ratings/{experiment}_key.csv",
    log:
        "joblogs/ratings/{experiment}.log",
    params:
        conditions=lambda wildcards: rated(wildcards.experiment),
        rated=lambda wildcards: settings(wildcards)["generation"]["rated"],
        words=lambda wildcards: study.experiments[wildcards.experiment].words["action"],
        seed=lambda wildcards: settings(wildcards)["seed"],
        code=tracked("ratings.py"),
    script:
        "../scripts/ratings.py"


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
                f"figures/{name}_{figure}.{FIGURES[figure].forms[0]}",
                caption="../report/figure.rst",
                category="Figures",
                labels=figure_labels(f"{name}_{figure}"),
            )
            for name in study.experiments
            for figure in figures_of(name)
        ],
        diagnostics=[
            f"diagnostics/{name}_D{D}.csv"
            for name in study.experiments
            for D in study.experiments[name].settings["D"]
        ],
        droppable=list(dict(droppable()).values()),
    output:
        report("report.html", caption="../report/report.rst", category="Report"),
    log:
        "joblogs/report.log",
    params:
        config=config_name(),
        droppable=list(dict(droppable())),
        experiments={name: portable(experiment) for name, experiment in study.experiments.items()},
        python=python_version(),
        packages=pinned_packages(),
        hashes={"code": study_hash(), "environment.lock": lock_hash()},
        code=tracked("report.py"),
    script:
        "../scripts/report.py"
