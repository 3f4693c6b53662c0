"""Apply the transforms that were fitted on training trials to the trials of a test set."""

from features.percept_data import join, load_percepts
from features.table import write_table
from features.transforms import apply, load_transforms, table_metadata
from workflow.execution.job import job

with job(snakemake) as (files, out):
    transforms = load_transforms(files.transforms)
    percepts = join(map(load_percepts, files.percepts))
    write_table(apply(transforms, percepts), out.trials, out.objects, table_metadata(transforms, percepts))
