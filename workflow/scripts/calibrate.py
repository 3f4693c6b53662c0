"""Log what the camera sees of an empty table and of the calibration marks."""

from data_collection.episode import calibrate
from data_collection.log.mcap_log import write_log
from data_collection.simulation_settings import Simulation
from workflow.artifacts.provenance import parts_of_code
from workflow.execution.job import job

with job(snakemake) as (_, out):
    log = calibrate(
        Simulation.model_validate(snakemake.params.simulation),
        experiment=snakemake.wildcards.experiment,
        seed=snakemake.params.seed,
        provenance=parts_of_code(snakemake.params.code),
    )
    write_log(out[0], log)
