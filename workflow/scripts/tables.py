"""Render every table in all its forms."""

from pathlib import Path

from evaluation.rendering import sheets, write
from workflow.execution.job import job

with job(snakemake):
    files = snakemake.input
    made = sheets(snakemake.params.tables, Path(files.scores), [Path(path) for path in files.uncertain])
    for name, sheet in made.items():
        write(name, sheet, Path(snakemake.output[0]).parent)
