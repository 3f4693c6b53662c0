"""Fit the feature transforms on the first D trials and apply them."""

from features.extraction_settings import FeatureSettings
from features.percept_data import first, join, load_percepts
from features.table import write_table
from features.transforms import apply, fit_transforms, save_transforms, table_metadata
from workflow.execution.job import job

with job(snakemake) as (files, out):
    weights = {"weights": str(files.weights)} if files.get("weights") else {}
    D = int(snakemake.wildcards.D)
    names = ("features", snakemake.wildcards.experiment, D)
    percepts = first(join(map(load_percepts, files.percepts)), D)
    extraction = FeatureSettings.model_validate(snakemake.params.extraction | weights)
    transforms = fit_transforms(percepts, extraction, snakemake.params.seed, *names)
    save_transforms(out.transforms, transforms)
    write_table(apply(transforms, percepts), out.trials, out.objects, table_metadata(transforms, percepts))
