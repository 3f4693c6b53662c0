"""Let each fit of one experiment and D answer uncertain instructions, made from those of the test set."""

import pandas as pd

from evaluation.scores import write_csv
from evaluation.uncertain.answers import answer_uncertain
from evaluation.uncertain.instructions import instructions
from features.table import read_table
from model import load
from workflow.execution.job import job

with job(snakemake) as (files, out):
    table = read_table(files.trials, files.objects, need_attention=False)
    asked = instructions(table, snakemake.params.words)
    rows = [
        row
        for path, condition in zip(files.fits, snakemake.params.conditions, strict=True)
        for row in answer_uncertain(condition, load(path), asked)
    ]
    write_csv(pd.DataFrame(rows), out[0])
