"""Put all that people look at on one page that opens from disk."""

import json
from pathlib import Path

import pandas as pd

from data_collection.files import write_text
from evaluation.convergence import read_lights
from evaluation.pages import causes, lights, origins, report, variance
from evaluation.pages.page import page
from evaluation.rendering import sheets
from evaluation.scores import read_scores
from features.table import read_metadata
from workflow.execution.job import job

with job(snakemake) as (files, out):
    params = snakemake.params
    tables = report.without_repeats(sheets(params.tables, files.scores, files.uncertain, files.convergence))
    claims, comparisons = (pd.read_csv(path, dtype=str, keep_default_na=False) for path in files.claims)
    made = {name: read_metadata(path) for name, path in zip(params.droppable, files.droppable, strict=True)}
    dropped = {name: json.loads(told.get("dropped", "[]")) for name, told in made.items()}
    attempts: dict[str, list[int]] = {}
    for name, path in zip(params.tried, files.tried, strict=True):
        attempts.setdefault(name, []).extend(json.loads(read_metadata(path).get("attempts", "[]")))
    scores = read_scores([files.scores])
    sections = [
        report.about(params.config, params.sources, scores, dropped, attempts),
        report.claims(claims, comparisons, tables),
        report.tables(tables),
        report.figures(params.figures, Path()),
        causes.section(scores),
        variance.section(pd.read_csv(files.variance)),
        lights.section(read_lights(files.convergence), folded=True),
        origins.settings(params.config, params.settings),
        origins.versions(params.python, params.packages, params.hashes),
        origins.reproduction(params.config),
    ]
    write_text(out[0], page("Cross-situational learning: the study", sections))
