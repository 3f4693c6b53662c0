"""Draw how the most probable fit of a condition understands the instructions of the test set."""

from pathlib import Path

from evaluation.best_fit import by_log_joint, title
from evaluation.figures.drawing import save_figure
from evaluation.figures.instructions import answers_figure
from features.table import read_table
from workflow.execution.job import job

with job(snakemake):
    best, fit = by_log_joint(Path(path) for path in snakemake.input.fits)[0]
    shown = title(snakemake.params.condition, fit, best, len(snakemake.input.fits))
    table = read_table(Path(snakemake.input.trials), Path(snakemake.input.objects), need_attention=False)
    save_figure(answers_figure(fit, table, shown), *map(Path, snakemake.output))
