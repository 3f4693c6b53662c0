"""Simulate a block of trials and log each."""

from pathlib import Path

from data_collection.episode import collect
from data_collection.log.mcap_log import write_log
from data_collection.settings import Simulation
from workflow.artifacts.provenance import lock_hash
from workflow.execution.job import job

with job(snakemake):
    logs = collect(
        Simulation.from_mapping(snakemake.params.simulation),
        experiment=snakemake.params.experiment,
        set_name=snakemake.params.set_name,
        trials=snakemake.params.trials,
        seed=snakemake.params.seed,
        provenance={"code_sha256": snakemake.params.code, "lock_sha256": lock_hash()},
    )
    for path, log in zip(snakemake.output, logs, strict=True):
        write_log(Path(path), log)
