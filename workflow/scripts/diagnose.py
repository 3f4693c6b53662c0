"""Diagnose the chains of each condition of an experiment and D."""

from pathlib import Path

from evaluation.pages.diagnostics import diagnose_condition, write_page
from model import load
from workflow.execution.job import job

with job(snakemake):
    parts = [
        diagnose_condition(condition, [load(Path(path)) for path in paths])
        for condition, paths in snakemake.params.conditions
    ]
    names = snakemake.wildcards
    title = f"Chains of {names.experiment}, D = {names.D}"
    write_page(title, parts, Path(snakemake.output.table), Path(snakemake.output.page))
