"""Fits of the model: one for each experiment, variant, method, inference, D, ROW and seed."""


rule fit:
    input:
        unpack(table_files("train")),
    output:
        FIT_PATH,
    log:
        "joblogs/fit/{experiment}/{variant}_{method}_{inference}_D{D}_ROW{ROW}_seed{seed}.log",
    params:
        **{
            key: lambda wildcards, key=key: settings(wildcards)[key]
            for key in ("seed", "iterations", "chains", "temperature", "keep_history")
        },
        data=lambda wildcards: study.experiments[wildcards.experiment].data,
        priors=lambda wildcards: study.experiments[wildcards.experiment].priors(wildcards.variant),
        sampler=lambda wildcards: {
            "averaged_draws": averaged_draws(wildcards.inference),
            "empty_category": settings(wildcards)["empty_category"],
        },
        code=tracked("fit.py"),
    script:
        "../scripts/fit.py"
