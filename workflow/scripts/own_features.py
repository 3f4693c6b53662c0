"""Take over feature tables that somebody brings: of training trials the first D, of a test set all."""

from features.table import head, import_table, write_table
from features.table_parts import place_of
from workflow.execution.job import job

with job(snakemake) as (files, out):
    set_name = snakemake.wildcards.set
    table = import_table(place_of(files.trials), place_of(files.objects), need_attention=set_name != "generation")
    table = head(table, int(snakemake.wildcards.D)) if set_name == "train" else table
    write_table(table, out.trials, out.objects)
