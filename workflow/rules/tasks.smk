"""The tasks that use what was learned: the robot does what it is told, and tells what it did."""


rule describe:
    input:
        unpack(table_files("description")),
        fits=lambda wildcards: [condition.path for condition in tested(wildcards, "description")],
    output:
        scores="scores/{experiment}_D{D}_description.csv",
        descriptions="descriptions/{experiment}_D{D}.csv",
    log:
        "joblogs/describe/{experiment}/D{D}.log",
    group:
        "results"
    params:
        conditions=lambda wildcards: names_of(tested(wildcards, "description")),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("describe.py"),
    script:
        "../scripts/describe.py"


rule generate:
    input:
        unpack(table_files("generation")),
        unpack(scene_files),
        fit=FIT_PATH,
    output:
        answers=f"{GENERATION_PATH}/answers.csv",
        scores=f"{GENERATION_PATH}/scores.csv",
        logs=directory(f"{GENERATION_PATH}/mcap"),
    log:
        "joblogs/generate/{experiment}/{variant}/{method}/{sampler}/D{D}_ROW{ROW}_seed{seed}.log",
    group:
        "fits"
    params:
        data=lambda wildcards: study.experiments[wildcards.experiment].data,
        simulation=lambda wildcards: simulation_of(study.experiments[wildcards.experiment].data),
        seed=lambda wildcards: settings(wildcards).seed,
        stream=lambda wildcards: settings(wildcards).samplers[wildcards.sampler].stream,
        data_seed=lambda wildcards: study.experiments[study.experiments[wildcards.experiment].data].settings.seed,
        code=tracked("generate.py"),
    script:
        "../scripts/generate.py"


rule evaluate_generation:
    input:
        lambda wildcards: [
            f"{GENERATION_PATH}/answers.csv".format(**condition.wildcards)
            for condition in tested(wildcards, "generation")
        ],
    output:
        "scores/{experiment}_D{D}_generation.csv",
    log:
        "joblogs/evaluate/{experiment}/D{D}_generation.log",
    group:
        "results"
    params:
        conditions=lambda wildcards: names_of(tested(wildcards, "generation")),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("evaluate_generation.py"),
    script:
        "../scripts/evaluate_generation.py"


rule uncertain:
    input:
        unpack(table_files("generation")),
        fits=lambda wildcards: [condition.path for condition in tested(wildcards, "generation")],
    output:
        "uncertain/{experiment}_D{D}.csv",
    log:
        "joblogs/uncertain/{experiment}/D{D}.log",
    group:
        "results"
    params:
        conditions=lambda wildcards: names_of(tested(wildcards, "generation")),
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("uncertain.py"),
    script:
        "../scripts/uncertain.py"
