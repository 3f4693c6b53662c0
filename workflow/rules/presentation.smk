"""What people look at: tables, figures, and clips to rate."""


rule tables:
    input:
        scores="scores.csv",
        convergence="convergence.csv",
        uncertain=[path for name in INSTRUCTED for path in uncertain_files(study.sets(name))],
    output:
        expand("tables/{file}", file=files_of_tables(TABLES)),
    log:
        "joblogs/tables.log",
    group:
        "results"
    params:
        tables=TABLES,
        code=tracked("tables.py"),
    script:
        "../scripts/tables.py"


rule claims:
    input:
        scores="scores.csv",
        convergence="convergence.csv",
        descriptions=tested_files(
            [*study.sets("simulator"), *study.sets("real")], "description", "descriptions/{experiment}_D{D}.csv"
        ),
        shaded=[path for one in shaded() for path in (*one["fits"], one["trials"], one["objects"])],
    output:
        claims="claims.csv",
        comparisons="claims_comparisons.csv",
        shades="claims_shades.csv",
        page="claims.html",
    log:
        "joblogs/claims.log",
    group:
        "results"
    params:
        shaded=list(shaded()),
        code=tracked("claims.py"),
    script:
        "../scripts/claims.py"


rule count_confusions:
    input:
        "descriptions/{experiment}_D{D}.csv",
    output:
        "confusion/{experiment}_D{D}.csv",
    log:
        "joblogs/confusion/{experiment}/D{D}.log",
    group:
        "results"
    params:
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("count_confusions.py"),
    script:
        "../scripts/count_confusions.py"


# A rule for each figure of the catalogue, all with the same script.
for name, figure in FIGURES.items():

    rule:
        name:
            f"figure_{name.partition('{')[0].rstrip('_')}"
        input:
            unpack(lambda wildcards, kind=figure.inputs: figure_inputs(kind, *shown_by(wildcards))[0]),
        output:
            [f"figures/{{experiment}}_{name}.{form}" for form in figure.forms],
        log:
            f"joblogs/figures/{{experiment}}/{name}.log",
        wildcard_constraints:
            experiment="|".join({own: None for shown, own, *_ in SHOWN_FIGURES if shown == name}) or "(?!)",
            sampler=f"(?:{'|'.join({own: None for *_, own in SHOWN_FIGURES})})",  # may be empty
        group:
            "data" if figure.inputs in DATA_INPUTS else "results"
        params:
            draw=figure.draw,
            modules=[figure.module],
            settings=lambda wildcards, kind=figure.inputs: figure_inputs(kind, *shown_by(wildcards))[1],
            code=tracked("figure.py", figure.module),
        script:
            "../scripts/figure.py"


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
    group:
        "results"
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
        variance="variance.csv",
        claims=[
            report("claims.csv", caption="../report/claims.rst", category="Claims"),
            "claims_comparisons.csv",
        ],
        tables=[
            report(
                f"tables/{name}.html",
                caption="../report/table.rst",
                category="Tables",
                labels={"table": table.title},
            )
            for name, table in TABLES.items()
        ],
        uncertain=[path for name in INSTRUCTED for path in uncertain_files(study.sets(name))],
        figures=[
            report(
                figure.path,
                caption="../report/figure.rst",
                category="Figures",
                labels={"figure": figure.title, "shows": figure.caption},
            )
            for figure in [told_figure(*names) for names in SHOWN_FIGURES]
        ],
        convergence="convergence.csv",
        droppable=list(dict(droppable()).values()),
        tried=[path for _, path in tried()],
    output:
        report("report.html", caption="../report/report.rst", category="Report"),
    log:
        "joblogs/report.log",
    group:
        "results"
    params:
        config=config_name(),
        tables=TABLES,
        figures=[told_figure(*names) for names in SHOWN_FIGURES],
        droppable=list(dict(droppable())),
        tried=[name for name, _ in tried()],
        sources={name: source_in_words(experiment) for name, experiment in study.first_sets.items()},
        settings={name: all_settings(experiment) for name, experiment in study.first_sets.items()},
        python=python_version(),
        packages=pinned_packages(),
        hashes={"code": study_hash(), "environment.lock": lock_hash()},
        code=tracked("report.py"),
    script:
        "../scripts/report.py"
