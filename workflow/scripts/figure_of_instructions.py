"""Draw how the most probable fit of a condition understands the instructions of the test set."""

from pathlib import Path

from evaluation.figures import save_figure
from evaluation.figures_of_instructions import answers_figure
from features.table import read_table
from model import METHODS, load
from workflow.job import job

with job(snakemake):
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=False)
    fits = [load(Path(path)) for path in snakemake.input.fits]
    best = max(range(len(fits)), key=lambda i: float(fits[i].trace_log_joint[-1]))
    shown = snakemake.params.condition
    figure = answers_figure(
        fits[best],
        table,
        f"{shown['experiment']}, {METHODS[shown['method']].label}, D = {shown['D']}, ROW {shown['ROW']} %,\n"
        f"seed {best + 1} of {len(fits)} (highest log joint)",
    )
    for path in snakemake.output:
        save_figure(figure, Path(path))
