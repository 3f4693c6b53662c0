"""Decide the paper's claims from the scores and the descriptions."""

from pathlib import Path

from evaluation.claims.verdicts import judge_claims
from evaluation.description import read_descriptions
from evaluation.pages.claims import write_claims
from evaluation.scores import read_scores
from workflow.execution.job import job

with job(snakemake):
    scores = read_scores([Path(snakemake.input.scores)])
    descriptions = read_descriptions([Path(path) for path in snakemake.input.descriptions])
    claims, comparisons = judge_claims(scores, descriptions)
    out = snakemake.output
    write_claims(claims, comparisons, Path(out.claims), Path(out.comparisons), Path(out.page))
