"""Measure the fits of one experiment and D against the truth."""

import logging
from pathlib import Path

from evaluation.measures import Learned, measured
from evaluation.scores import LETTERS, score_rows, write_scores
from features.table import read_table
from model import load
from workflow.execution.job import job

with job(snakemake):
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=True)
    for channel in LETTERS:
        if getattr(table, f"truth_{channel}") is None:
            logging.warning(
                "%s: no column truth_%s, so that ARI of this channel stays empty",
                snakemake.input.trials if channel == "action" else snakemake.input.objects,
                channel,
            )
    rows = []
    for path, condition in zip(snakemake.input.fits, snakemake.params.conditions, strict=True):
        measures = measured("csl", Learned(load(Path(path)), table), snakemake.params.words)
        rows += score_rows({**condition, "task": "csl"}, measures)
    write_scores(rows, Path(snakemake.output[0]))
