"""Log what the camera sees of an empty table and of the calibration marks."""

from pathlib import Path

from data_collection.episode import calibrate
from data_collection.log.mcap_log import write_log
from data_collection.settings import Simulation
from workflow.artifacts.provenance import lock_hash
from workflow.execution.job import job

with job(snakemake):
    log = calibrate(
        Simulation.from_mapping(snakemake.params.simulation),
        experiment=snakemake.wildcards.experiment,
        seed=snakemake.params.seed,
        provenance={"code_sha256": snakemake.params.code, "lock_sha256": lock_hash()},
    )
    write_log(Path(snakemake.output[0]), log)
