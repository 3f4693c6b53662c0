"""Render every table in all its forms."""

from evaluation.rendering import sheets, write
from workflow.execution.job import job

with job(snakemake) as (files, out):
    made = sheets(snakemake.params.tables, files.scores, files.uncertain, files.convergence)
    for name, sheet in made.items():
        write(name, sheet, out[0].parent)
