"""Feature tables: from logs by way of percepts, or from files of one's own."""


rule perceive:
    input:
        unpack(weights_file),
        calibration=calibration_path,
        logs=logs_of_block,
    output:
        "percepts/{experiment}/{set}_{block}.npz",
    log:
        "joblogs/perceive/{experiment}/{set}_{block}.log",
    wildcard_constraints:
        experiment=sources("simulation", "logs"),
    group:
        "data"
    params:
        extraction=extraction,
        code=tracked("perceive.py"),
    script:
        "../scripts/perceive.py"


rule features:
    input:
        unpack(weights_file),
        percepts=lambda wildcards: percept_paths(wildcards.experiment, "train", wildcards.D),
    output:
        trials="features/{experiment}/D{D}/train_trials.parquet",
        objects="features/{experiment}/D{D}/train_objects.parquet",
        transforms="features/{experiment}/D{D}/transforms.npz",
    log:
        "joblogs/features/{experiment}/D{D}.log",
    wildcard_constraints:
        experiment=sources("simulation", "logs"),
    group:
        "data"
    params:
        seed=lambda wildcards: settings(wildcards).seed,
        extraction=extraction,
        code=tracked("features.py"),
    script:
        "../scripts/features.py"


# The transforms are fitted on training trials, and only applied to what the robot is tested on.
rule test_features:
    input:
        percepts=lambda wildcards: percept_paths(wildcards.experiment, wildcards.set),
        transforms="features/{experiment}/D{D}/transforms.npz",
    output:
        trials="features/{experiment}/D{D}/{set}_trials.parquet",
        objects="features/{experiment}/D{D}/{set}_objects.parquet",
    log:
        "joblogs/features/{experiment}/D{D}_{set}.log",
    wildcard_constraints:
        experiment=sources("simulation", "logs"),
        set="generation|description",
    group:
        "data"
    params:
        code=tracked("test_features.py"),
    script:
        "../scripts/test_features.py"


rule own_features:
    input:
        unpack(own_tables),
    output:
        trials="features/{experiment}/D{D}/{set}_trials.parquet",
        objects="features/{experiment}/D{D}/{set}_objects.parquet",
    log:
        "joblogs/own_features/{experiment}/D{D}_{set}.log",
    wildcard_constraints:
        experiment=sources("features"),
    group:
        "data"
    params:
        parts=own_part_names,
        code=tracked("own_features.py"),
    script:
        "../scripts/own_features.py"
