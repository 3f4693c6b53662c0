"""Put all that people look at on one page that opens from disk."""

import json
from pathlib import Path

import pandas as pd

from data_collection.files import replacing
from evaluation.pages import origins, report
from evaluation.pages.page import page
from evaluation.rendering import sheets
from evaluation.scores import read_scores
from features.table import read_metadata
from workflow.execution.job import job

with job(snakemake):
    files, params = snakemake.input, snakemake.params
    tables = sheets(params.tables, Path(files.scores), [Path(path) for path in files.uncertain])
    claims, comparisons = (pd.read_csv(path, dtype=str, keep_default_na=False) for path in files.claims)
    chains = {Path(path).stem: pd.read_csv(path) for path in files.diagnostics}
    made = {name: read_metadata(path) for name, path in zip(params.droppable, files.droppable, strict=True)}
    dropped = {name: json.loads(told.get("dropped", "[]")) for name, told in made.items()}
    sections = [
        report.about(params.config, params.sources, read_scores([Path(files.scores)]), dropped),
        report.claims(claims, comparisons, tables),
        report.tables(tables),
        report.figures(params.figures, Path()),
        report.diagnostics(chains),
        origins.settings(params.config, params.settings),
        origins.versions(params.python, params.packages, params.hashes),
        origins.reproduction(params.config),
    ]
    with replacing(Path(snakemake.output[0])) as (temporary,):
        temporary.write_text(page("Cross-situational learning: the study", sections), encoding="utf-8")
