"""Measures of the fits, tables and figures."""

from dataclasses import replace

from evaluation.catalogue import FIT_FIGURES, TABLE_FORMS, tables_of

TABLES = tables_of((name, D) for name, experiment in study.experiments.items() for D in experiment.settings["D"])


rule evaluate:
    input:
        unpack(train_table),
        fits=lambda wildcards: [c.path for c in study.conditions(wildcards.experiment) if c.D == int(wildcards.D)],
    output:
        "scores/{experiment}_D{D}_csl.csv",
    params:
        conditions=lambda wildcards: [
            vars(c) | {"averaged_draws": averaged_draws(c.inference), "chains": settings(wildcards)["chains"]}
            for c in study.conditions(wildcards.experiment)
            if c.D == int(wildcards.D)
        ],
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("evaluate.py"),
    log:
        "joblogs/evaluate/{experiment}_D{D}.log",
    script:
        "../scripts/evaluate.py"


rule scores:
    input:
        [f"scores/{name}_D{D}_csl.csv" for name in study.experiments for D in study.experiments[name].settings["D"]],
    output:
        "scores.csv",
    params:
        code=tracked("scores.py"),
    log:
        "joblogs/scores.log",
    script:
        "../scripts/scores.py"


rule table:
    input:
        "scores.csv",
    output:
        **{form: f"tables/{{table}}.{form}" for form in TABLE_FORMS},
    params:
        table=lambda wildcards: TABLES[wildcards.table],
        code=tracked("table.py"),
    log:
        "joblogs/tables/{table}.log",
    wildcard_constraints:
        table="|".join(TABLES),
    script:
        "../scripts/table.py"


rule figure_of_fit:
    input:
        fits=lambda wildcards: [
            replace(study.figure_condition(wildcards.experiment), seed=seed).path
            for seed in range(1, settings(wildcards)["seeds"] + 1)
        ],
    output:
        **{figure: f"figures/{{experiment}}_{figure}.png" for figure in FIT_FIGURES},
    params:
        condition=lambda wildcards: vars(study.figure_condition(wildcards.experiment)),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("figure_of_fit.py"),
    log:
        "joblogs/figures/{experiment}.log",
    script:
        "../scripts/figure_of_fit.py"
