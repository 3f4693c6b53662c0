"""Trials of the robot: one MCAP log per trial, and one of the camera's calibration per experiment."""


rule calibrate:
    output:
        "mcap/{experiment}/calibration.mcap",
    log:
        "joblogs/calibrate/{experiment}.log",
    wildcard_constraints:
        experiment=sources("simulation"),
    group:
        "data"
    params:
        seed=lambda wildcards: settings(wildcards).seed,
        simulation=lambda wildcards: simulation_of(wildcards.experiment),
        code=tracked("calibrate.py"),
    script:
        "../scripts/calibrate.py"


# A rule for each block, because the names of its logs do not tell the block.
for name, set_name, trials in simulated_blocks():

    rule:
        name:
            f"collect_{name}_{set_name}_{trials[0]}_to_{trials[-1]}"
        output:
            [log_path(name, set_name, trial) for trial in trials],
        log:
            f"joblogs/collect/{name}/{set_name}_{trials[0]:04}-{trials[-1]:04}.log",
        group:
            "data"
        params:
            experiment=name,
            set_name=set_name,
            trials=trials,
            seed=study.experiments[name].settings.seed,
            simulation=simulation_of(name),
            code=tracked("collect.py"),
        script:
            "../scripts/collect.py"
