"""Join the score files of all experiments into one, and tell apart what varies in it."""

from evaluation.scores import read_scores, write_csv
from evaluation.variance import variance_split
from workflow.execution.job import job

with job(snakemake) as (files, out):
    scores = read_scores(files)
    write_csv(scores, out.scores)
    write_csv(variance_split(scores), out.variance)
