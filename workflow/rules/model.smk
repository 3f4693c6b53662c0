"""Fits of the model: one per experiment, variant, method, sampler, D, ROW and seed, and more chains of some of them."""


rule fit:
    input:
        unpack(table_files("train")),
    output:
        FIT_PATH,
    log:
        "joblogs/fit/{experiment}/{variant}/{method}/{sampler}/D{D}_ROW{ROW}_seed{seed}.log",
    group:
        "fits"
    params:
        seed=lambda wildcards: settings(wildcards).seed,
        data=lambda wildcards: study.experiments[wildcards.experiment].data,
        priors=priors_of,
        sampler=lambda wildcards: plain(settings(wildcards).samplers[wildcards.sampler]),
        code=tracked("fit.py"),
    script:
        "../scripts/fit.py"


use rule fit as fit_chain with:
    output:
        CHAIN_PATH,
    log:
        "joblogs/fit_chain/{experiment}/{variant}/{method}/{sampler}/D{D}_ROW{ROW}_seed{seed}_chain{chain}.log",
