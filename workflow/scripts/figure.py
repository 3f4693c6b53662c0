"""Draw a figure of the catalogue: its rule names the function."""

from pkgutil import resolve_name

from evaluation.figures.drawing import save
from evaluation.figures.source import Source
from workflow.execution.job import job

with job(snakemake) as (files, out):
    draw = resolve_name(f"evaluation.figures.{snakemake.params.draw}")
    source = Source(dict(snakemake.wildcards.items()), dict(files.items()), snakemake.params.settings)
    save(draw(source), *out)
