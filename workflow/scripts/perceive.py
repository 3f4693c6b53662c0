"""See what the robot saw in a block of trials."""

from pathlib import Path

from data_collection.log.mcap_log import read_log
from features.extraction_settings import FeatureSettings
from features.percept_data import save_percepts
from features.percepts import perceive
from workflow.execution.job import job

with job(snakemake):
    weights = {"weights": snakemake.input.weights} if snakemake.input.get("weights") else {}
    percepts = perceive(
        (read_log(Path(path)) for path in snakemake.input.logs),
        read_log(Path(snakemake.input.calibration)),
        FeatureSettings.model_validate(snakemake.params.extraction | weights),
    )
    save_percepts(Path(snakemake.output[0]), percepts)
