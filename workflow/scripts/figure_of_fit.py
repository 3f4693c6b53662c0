"""Draw what the most probable fit of a condition has learned."""

from pathlib import Path

from evaluation.best_fit import by_log_joint, title
from evaluation.figures.drawing import save_figure
from evaluation.figures.fit import position_categories, word_distributions
from workflow.execution.job import job

with job(snakemake):
    best, fit = by_log_joint(Path(path) for path in snakemake.input.fits)[0]
    shown = title(snakemake.params.condition, fit, best, len(snakemake.input.fits))
    save_figure(word_distributions(fit, snakemake.params.words, shown), *map(Path, snakemake.output.words))
    save_figure(position_categories(fit, shown), *map(Path, snakemake.output.positions))
