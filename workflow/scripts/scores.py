"""Join the score files of all experiments into one."""

from pathlib import Path

from evaluation.scores import join_scores
from workflow.execution.job import job

with job(snakemake):
    join_scores([Path(path) for path in snakemake.input], Path(snakemake.output[0]))
