"""Decide the paper's claims from the scores and the descriptions."""

from evaluation.claims.lights import with_lights
from evaluation.claims.verdicts import judge_claims
from evaluation.convergence import read_lights
from evaluation.description import read_descriptions
from evaluation.pages.claims import write_claims
from evaluation.scores import read_scores
from workflow.execution.job import job

with job(snakemake) as (files, out):
    scores = read_scores([files.scores])
    descriptions = read_descriptions(files.descriptions)
    claims, comparisons = judge_claims(scores, descriptions)
    claims = with_lights(claims, read_lights(files.convergence))
    write_claims(claims, comparisons, out.claims, out.comparisons, out.page)
