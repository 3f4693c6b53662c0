"""Fits of the model: one for each experiment, variant, method, inference, D, ROW and seed."""


def train_table(wildcards):
    """The feature table that an experiment learns from: its own, or that of the experiment whose data it shares."""
    data = study.experiments[wildcards.experiment].data
    return {kind: f"features/{data}/D{wildcards.D}/train_{kind}.parquet" for kind in ("trials", "objects")}


rule fit:
    input:
        unpack(train_table),
    output:
        FIT_PATH,
    params:
        data=lambda wildcards: study.experiments[wildcards.experiment].data,
        priors=lambda wildcards: study.experiments[wildcards.experiment].priors(wildcards.variant),
        sampler=lambda wildcards: {
            "averaged_draws": averaged_draws(wildcards.inference),
            "empty_category": settings(wildcards)["empty_category"],
        },
        **{
            key: lambda wildcards, key=key: settings(wildcards)[key]
            for key in ("seed", "iterations", "chains")
        },
        code=tracked("fit.py"),
    log:
        "joblogs/fit/{experiment}_{variant}_{method}_{inference}_D{D}_ROW{ROW}_seed{seed}.log",
    script:
        "../scripts/fit.py"
