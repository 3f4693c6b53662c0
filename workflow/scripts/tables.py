"""Render every table in all its forms."""

from pathlib import Path

from evaluation.scores import read_scores
from evaluation.tables import render
from workflow.execution.job import job

with job(snakemake):
    scores = read_scores([Path(snakemake.input[0])])
    folder = Path(snakemake.output[0]).parent
    for name, table in snakemake.params.tables.items():
        render(scores, table, folder, name)
