"""Feature tables: from logs by way of percepts, or from files of one's own."""


def blocks_of(wildcards):
    """The blocks of trials that hold the first D trials."""
    return [block for block in study.blocks(wildcards.experiment) if block[0] <= int(wildcards.D)]


rule perceive:
    input:
        calibration=calibration_path,
        logs=lambda wildcards: [
            log_path(wildcards.experiment, wildcards.set, trial)
            for block in study.blocks(wildcards.experiment)
            if wildcards.block == f"{block[0]:04}-{block[-1]:04}"
            for trial in block
        ],
    output:
        "percepts/{experiment}/{set}_{block}.npz",
    params:
        extraction=lambda wildcards: settings(wildcards).get("feature_extraction", {}),
        code=tracked("perceive.py"),
    log:
        "joblogs/perceive/{experiment}_{set}_{block}.log",
    wildcard_constraints:
        experiment=sources("simulation", "logs"),
    script:
        "../scripts/perceive.py"


rule features:
    input:
        percepts=lambda wildcards: [
            f"percepts/{wildcards.experiment}/train_{block[0]:04}-{block[-1]:04}.npz" for block in blocks_of(wildcards)
        ],
    output:
        trials="features/{experiment}/D{D}/train_trials.parquet",
        objects="features/{experiment}/D{D}/train_objects.parquet",
        transforms="features/{experiment}/D{D}/transforms.npz",
    params:
        seed=lambda wildcards: settings(wildcards)["seed"],
        extraction=lambda wildcards: settings(wildcards).get("feature_extraction", {}),
        code=tracked("features.py"),
    log:
        "joblogs/features/{experiment}_D{D}.log",
    wildcard_constraints:
        experiment=sources("simulation", "logs"),
    script:
        "../scripts/features.py"


rule own_features:
    input:
        unpack(lambda wildcards: feature_files(study, wildcards.experiment)),
    output:
        trials="features/{experiment}/D{D}/train_trials.parquet",
        objects="features/{experiment}/D{D}/train_objects.parquet",
    params:
        words=lambda wildcards: study.experiments[wildcards.experiment].words,
        code=tracked("own_features.py"),
    log:
        "joblogs/own_features/{experiment}_D{D}.log",
    wildcard_constraints:
        experiment=sources("features"),
    script:
        "../scripts/own_features.py"
