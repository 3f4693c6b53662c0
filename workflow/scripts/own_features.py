"""Take over the first D trials of feature tables that somebody brings."""

from pathlib import Path

from features.table import head, read_table, write_table
from workflow.job import job

with job(snakemake.log[0]):
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    write_table(
        head(table, int(snakemake.wildcards.D)), Path(snakemake.output.trials), Path(snakemake.output.objects)
    )
