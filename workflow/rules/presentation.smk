"""What people look at: tables, figures, and clips to rate."""


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
        "joblogs/figures/{experiment}/features.log",
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
        "joblogs/figures/{experiment}/fit.log",
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
        "joblogs/figures/{experiment}/instructions.log",
    params:
        condition=lambda wildcards: vars(study.generation_condition(wildcards.experiment)),
        code=tracked("figure_of_instructions.py"),
    script:
        "../scripts/figure_of_instructions.py"


rule present_uncertain:
    input:
        lambda wildcards: [
            f"uncertain/{wildcards.experiment}_D{D}.csv" for D in study.tested_D(wildcards.experiment, "generation")
        ],
    output:
        **{form: f"tables/{{experiment}}_uncertain.{form}" for form in TABLE_FORMS},
        **{form: f"figures/{{experiment}}_uncertain.{form}" for form in ("png", "pdf")},
    log:
        "joblogs/figures/{experiment}/uncertain.log",
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
        "joblogs/figures/{experiment}/categories.log",
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
        "joblogs/confusion/{experiment}/D{D}.log",
    params:
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("count_confusions.py"),
    script:
        "../scripts/count_confusions.py"


rule figure_of_confusion:
    input:
        lambda wildcards: [
            f"confusion/{wildcards.experiment}_D{D}.csv" for D in study.tested_D(wildcards.experiment, "description")
        ],
    output:
        files_of("confusion_{method}"),
    log:
        "joblogs/figures/{experiment}/confusion_{method}.log",
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
        "joblogs/figures/{experiment}/generation.log",
    params:
        condition=lambda wildcards: vars(study.generation_condition(wildcards.experiment)),
        code=tracked("figure_of_generation.py"),
    script:
        "../scripts/figure_of_generation.py"


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
        rated=lambda wildcards: settings(wildcards).generation.rated,
        words=lambda wildcards: study.experiments[wildcards.experiment].words["action"],
        seed=lambda wildcards: settings(wildcards).seed,
        code=tracked("ratings.py"),
    script:
        "../scripts/ratings.py"


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
                f"figures/{name}_{figure}.{figure_of(figure).forms[0]}",
                caption="../report/figure.rst",
                category="Figures",
                labels=figure_labels(f"{name}_{figure}"),
            )
            for name in study.experiments
            for figure in figures_of(name)
        ],
        diagnostics=expand("diagnostics/{chains}.csv", chains=diagnosed()),
        droppable=list(dict(droppable()).values()),
    output:
        report("report.html", caption="../report/report.rst", category="Report"),
    log:
        "joblogs/report.log",
    params:
        config=config_name(),
        droppable=list(dict(droppable())),
        sources={name: source_in_words(experiment) for name, experiment in study.experiments.items()},
        settings={name: overview(experiment) for name, experiment in study.experiments.items()},
        python=python_version(),
        packages=pinned_packages(),
        hashes={"code": study_hash(), "environment.lock": lock_hash()},
        code=tracked("report.py"),
    script:
        "../scripts/report.py"
