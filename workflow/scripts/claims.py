"""Decide the paper's claims from the scores, the descriptions, and the fits of Figure 8."""

import pandas as pd

from evaluation.claims.lights import with_lights
from evaluation.claims.shades import Shade, apart, shades_of
from evaluation.claims.terms import SHADED_WORD, SHADES_APART
from evaluation.claims.verdicts import judge_claims
from evaluation.convergence import read_lights
from evaluation.description import read_descriptions
from evaluation.figures.source import by_log_joint
from evaluation.pages.claims import write_claims
from evaluation.scores import COLUMNS, CONDITION, read_scores, score_rows, write_csv
from features.table import read_table
from workflow.execution.job import job

with job(snakemake) as (files, out):
    scores = read_scores([files.scores])
    descriptions = read_descriptions(files.descriptions)
    rows, found = [], []
    for one in snakemake.params.shaded:
        place, fit = by_log_joint(one["fits"])[0]
        condition = one["condition"] | {"seed": place + 1}
        table = read_table(one["trials"], one["objects"], need_attention=True)
        shades = shades_of(fit, table, {(what, word): shade for what, word, shade in one["shades"]}, SHADED_WORD)
        rows += [condition | shade._asdict() for shade in shades]
        found += score_rows(condition | {"task": "csl"}, {SHADES_APART: apart(shades)})
    write_csv(pd.DataFrame(rows, columns=[*(key for key in CONDITION if key != "task"), *Shade._fields]), out.shades)
    claims, comparisons = judge_claims(scores, descriptions, pd.DataFrame(found, columns=COLUMNS))
    claims = with_lights(claims, read_lights(files.convergence))
    write_claims(claims, comparisons, out.claims, out.comparisons, out.page)
