"""Measure the answers of each fit of one experiment and D."""

from pathlib import Path

from evaluation.generation import measures, read_answers
from evaluation.scores import score_rows, write_scores
from workflow.job import job

with job(snakemake):
    rows = [
        row
        for path, condition in zip(snakemake.input, snakemake.params.conditions, strict=True)
        for row in score_rows(condition | {"task": "generation"}, measures(read_answers(Path(path))))
    ]
    write_scores(rows, Path(snakemake.output[0]))
