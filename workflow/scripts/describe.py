"""Let each fit of one experiment and D describe the actions of the test set, and measure the descriptions."""

import pandas as pd

from evaluation.description import COLUMNS, describe_trials
from evaluation.measures import measured
from evaluation.scores import score_rows, write_csv, write_scores
from features.table import read_table
from model import load
from workflow.execution.job import job

with job(snakemake) as (files, out):
    words = snakemake.params.words
    table = read_table(files.trials, files.objects, need_attention=True)
    rows, descriptions = [], []
    for path, names in zip(files.fits, snakemake.params.conditions, strict=True):
        condition = names | {"task": "description"}
        told = describe_trials(load(path), table, words)
        descriptions.append(told.assign(**condition)[[*condition, *COLUMNS]])
        rows += score_rows(condition, measured("description", told, words))
    write_csv(pd.concat(descriptions), out.descriptions)
    write_scores(rows, out.scores)
