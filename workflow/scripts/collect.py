"""Simulate a block of trials and log each."""

from data_collection.episode import collect
from data_collection.log.mcap_log import write_log
from data_collection.simulation_settings import Simulation
from workflow.artifacts.provenance import parts_of_code
from workflow.execution.job import job

with job(snakemake) as (_, out):
    logs = collect(
        Simulation.model_validate(snakemake.params.simulation),
        experiment=snakemake.params.experiment,
        set_name=snakemake.params.set_name,
        trials=snakemake.params.trials,
        seed=snakemake.params.seed,
        provenance=parts_of_code(snakemake.params.code),
    )
    for path, log in zip(out, logs, strict=True):
        write_log(path, log)
