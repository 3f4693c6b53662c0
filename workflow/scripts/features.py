"""Fit the feature transforms on the first D trials and apply them."""

from pathlib import Path

from features.extraction_settings import FeatureSettings
from features.percept_data import first, join, load_percepts
from features.table import write_table
from features.transforms import apply, fit_transforms, save_transforms, table_metadata
from workflow.execution.job import job

with job(snakemake):
    weights = {"weights": snakemake.input.weights} if snakemake.input.get("weights") else {}
    D = int(snakemake.wildcards.D)
    names = ("features", snakemake.wildcards.experiment, D)
    percepts = first(join([load_percepts(Path(path)) for path in snakemake.input.percepts]), D)
    extraction = FeatureSettings.model_validate(snakemake.params.extraction | weights)
    transforms = fit_transforms(percepts, extraction, snakemake.params.seed, *names)
    save_transforms(Path(snakemake.output.transforms), transforms)
    write_table(
        apply(transforms, percepts),
        Path(snakemake.output.trials),
        Path(snakemake.output.objects),
        table_metadata(transforms, percepts.dropped),
    )
