"""Draw what the robot saw and felt in the training trials of an experiment."""

from pathlib import Path

from data_collection.log.mcap_log import read_log
from data_collection.log.trial import observation
from evaluation.figures.drawing import save_figure
from evaluation.figures.features import IMAGES, features_overview
from features.overview import overview
from features.percept_data import first, join, load_percepts
from features.table import read_table
from features.transforms import load_transforms
from workflow.execution.job import job

with job(snakemake):
    names, D = snakemake.wildcards, snakemake.params.D
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    percepts = first(join([load_percepts(Path(path)) for path in snakemake.input.percepts]), D)
    seen = overview(percepts, load_transforms(Path(snakemake.input.transforms)), table, snakemake.params.groups)
    paths = dict(zip(snakemake.params.trials, snakemake.input.logs, strict=True))
    # Where many trials were dropped, fewer than that are among the first logs.
    shown = [trial for trial in seen.trial[:IMAGES].tolist() if trial in paths]
    images = [observation(read_log(Path(paths[trial]))).image_before for trial in shown]
    save_figure(features_overview(seen, images, f"{names.experiment}, D = {D}"), Path(snakemake.output[0]))
