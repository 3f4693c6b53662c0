"""See what the robot saw in a block of trials."""

from data_collection.log.mcap_log import read_log
from features.extraction_settings import FeatureSettings
from features.percept_data import save_percepts
from features.percepts import perceive
from workflow.execution.job import job

with job(snakemake) as (files, out):
    weights = {"weights": str(files.weights)} if files.get("weights") else {}
    extraction = FeatureSettings.model_validate(snakemake.params.extraction | weights)
    save_percepts(out[0], perceive(map(read_log, files.logs), read_log(files.calibration), extraction))
