"""Join the score files of all experiments into one."""

from pathlib import Path

from evaluation.scores import read_scores, write_csv
from workflow.execution.job import job

with job(snakemake):
    write_csv(read_scores(Path(path) for path in snakemake.input), Path(snakemake.output[0]))
