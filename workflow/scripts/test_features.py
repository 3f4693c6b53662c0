"""Apply the transforms that were fitted on training trials to the trials of a test set."""

from pathlib import Path

from features.percept_data import join, load_percepts
from features.table import write_table
from features.transforms import apply, load_transforms, table_metadata
from workflow.execution.job import job

with job(snakemake):
    transforms = load_transforms(Path(snakemake.input.transforms))
    percepts = join([load_percepts(Path(path)) for path in snakemake.input.percepts])
    write_table(
        apply(transforms, percepts),
        Path(snakemake.output.trials),
        Path(snakemake.output.objects),
        table_metadata(transforms, percepts.dropped),
    )
