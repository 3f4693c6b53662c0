"""Draw a figure of the catalogue: its rule names the function."""

from pathlib import Path
from pkgutil import resolve_name

from evaluation.figures.drawing import save
from evaluation.figures.source import Source
from workflow.execution.job import job

with job(snakemake):
    draw = resolve_name(f"evaluation.figures.{snakemake.params.draw}")
    files = {name: [Path(path) for path in paths] for name, paths in snakemake.input.items()}
    source = Source(dict(snakemake.wildcards.items()), files, snakemake.params.settings)
    save(draw(source), *map(Path, snakemake.output))
