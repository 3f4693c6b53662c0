"""Take over feature tables that somebody brings: of training trials the first D, of a test set all."""

from pathlib import Path

from features.table import head, import_table, write_table
from workflow.execution.job import job

with job(snakemake):
    train = snakemake.wildcards.set == "train"
    table = import_table(
        Path(snakemake.input.trials),
        Path(snakemake.input.objects),
        need_attention=snakemake.wildcards.set != "generation",
    )
    table = head(table, int(snakemake.wildcards.D)) if train else table
    write_table(table, Path(snakemake.output.trials), Path(snakemake.output.objects))
