"""Let each fit of one experiment and D describe the actions of the test set, and measure the descriptions."""

from pathlib import Path

from evaluation.description import describe_trials, write_descriptions
from evaluation.measures import measured
from evaluation.scores import score_rows, write_scores
from features.table import read_table
from model import load
from workflow.execution.job import job

with job(snakemake):
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    told = [describe_trials(load(Path(path)), table, snakemake.params.words) for path in snakemake.input.fits]
    conditions = [condition | {"task": "description"} for condition in snakemake.params.conditions]
    rows = [
        row
        for condition, one in zip(conditions, told, strict=True)
        for row in score_rows(condition, measured("description", one, snakemake.params.words))
    ]
    write_descriptions(conditions, told, Path(snakemake.output.descriptions))
    write_scores(rows, Path(snakemake.output.scores))
