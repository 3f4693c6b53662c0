"""Render the table of uncertain instructions of an experiment, and draw those of one condition."""

from pathlib import Path

from evaluation.catalogue import TABLE_FORMS
from evaluation.figures.drawing import save_figure
from evaluation.figures.instructions import uncertain_figure
from evaluation.uncertain.answers import of_condition, read_uncertain, render_uncertain
from workflow.execution.job import job

with job(snakemake):
    answered = read_uncertain([Path(path) for path in snakemake.input])
    out, shown = snakemake.output, snakemake.params.condition
    render_uncertain(
        answered, f"Uncertain instructions, {shown['experiment']}", {form: Path(out[form]) for form in TABLE_FORMS}
    )
    figure = uncertain_figure(
        of_condition(answered, shown), f"{shown['experiment']}, D = {shown['D']}, ROW {shown['ROW']} %"
    )
    for form in ("png", "pdf"):
        save_figure(figure, Path(out[form]))
