"""Render one table in all its forms."""

from pathlib import Path

from evaluation.scores import read_scores
from evaluation.tables import render
from workflow.job import job

with job(snakemake.log[0]):
    paths = {form: Path(path) for form, path in snakemake.output.items()}
    render(read_scores([Path(snakemake.input[0])]), snakemake.params.table, paths)
