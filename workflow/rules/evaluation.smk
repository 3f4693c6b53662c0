"""Measures of learning, and the one file that holds the measures of everything."""


rule evaluate_learning:
    input:
        unpack(table_files("train")),
        fits=lambda wildcards: [condition.path for condition in tested(wildcards, "csl")],
    output:
        "scores/{experiment}_D{D}_csl.csv",
    log:
        "joblogs/evaluate/{experiment}/D{D}_csl.log",
    group:
        "results"
    params:
        conditions=lambda wildcards: names_of(tested(wildcards, "csl")),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("evaluate_learning.py"),
    script:
        "../scripts/evaluate_learning.py"


rule diagnose:
    input:
        lambda wildcards: [path for _, paths in chains_of(wildcards) for path in paths],
    output:
        table="diagnostics/{experiment}_D{D}.csv",
        page="diagnostics/{experiment}_D{D}.html",
    log:
        "joblogs/diagnose/{experiment}/D{D}.log",
    group:
        "results"
    params:
        conditions=chains_of,
        code=tracked("diagnose.py"),
    script:
        "../scripts/diagnose.py"


rule convergence:
    input:
        chains=expand("diagnostics/{chains}.csv", chains=diagnosed()),
        scores="scores.csv",
    output:
        diagnostics="diagnostics.csv",
        convergence="convergence.csv",
        page="diagnostics.html",
    log:
        "joblogs/convergence.log",
    group:
        "results"
    params:
        code=tracked("convergence.py"),
    script:
        "../scripts/convergence.py"


rule scores:
    input:
        list(score_files()),
    output:
        scores="scores.csv",
        variance="variance.csv",
    log:
        "joblogs/scores.log",
    group:
        "results"
    params:
        code=tracked("scores.py"),
    script:
        "../scripts/scores.py"
