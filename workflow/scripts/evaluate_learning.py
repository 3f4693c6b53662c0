"""Measure the fits of one experiment and D against the truth."""

import logging

from evaluation.learned import Learned
from evaluation.measures import measured
from evaluation.scores import LETTERS, score_rows, write_scores
from features.table import read_table
from model import load
from workflow.execution.job import job

with job(snakemake) as (files, out):
    table = read_table(files.trials, files.objects, need_attention=True)
    for channel in LETTERS:
        if getattr(table, f"truth_{channel}") is None:
            logging.warning(
                "%s: no column truth_%s, so that ARI of this channel stays empty",
                files.trials if channel == "action" else files.objects,
                channel,
            )
    rows = []
    for path, condition in zip(files.fits, snakemake.params.conditions, strict=True):
        measures = measured("csl", Learned(load(path), table), snakemake.params.words)
        rows += score_rows({**condition, "task": "csl"}, measures)
    write_scores(rows, out[0])
