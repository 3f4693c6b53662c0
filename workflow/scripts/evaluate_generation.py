"""Measure the answers of each fit of one experiment and D."""

from pathlib import Path

from evaluation.chance import generation_chance
from evaluation.generation import measures, read_answers
from evaluation.scores import score_rows, write_scores
from workflow.execution.job import job

with job(snakemake):
    rows = []
    for path, condition in zip(snakemake.input, snakemake.params.conditions, strict=True):
        answered = read_answers(Path(path))
        measured = measures(answered) | generation_chance(answered, snakemake.params.words)
        rows += score_rows(condition | {"task": "generation"}, measured)
    write_scores(rows, Path(snakemake.output[0]))
