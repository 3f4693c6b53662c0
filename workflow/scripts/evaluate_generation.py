"""Measure the answers of each fit of one experiment and D."""

from evaluation.generation import read_answers
from evaluation.measures import measured
from evaluation.scores import score_rows, write_scores
from workflow.execution.job import job

with job(snakemake) as (files, out):
    rows = []
    for path, condition in zip(files, snakemake.params.conditions, strict=True):
        measures = measured("generation", read_answers(path), snakemake.params.words)
        rows += score_rows(condition | {"task": "generation"}, measures)
    write_scores(rows, out[0])
