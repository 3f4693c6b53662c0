"""Draw what the robot saw of the objects in each category of the most probable fit of a condition."""

from pathlib import Path

from evaluation.best_fit import by_log_joint, title
from evaluation.catalogue import CATEGORY_FIGURES
from evaluation.figures.categories import category_crops
from evaluation.figures.drawing import save_figure
from features.percept_data import first, join, load_percepts
from workflow.execution.job import job

with job(snakemake):
    best, fit = by_log_joint(Path(path) for path in snakemake.input.fits)[0]
    condition = snakemake.params.condition
    shown = title(condition, fit, best, len(snakemake.input.fits))
    seen = first(join([load_percepts(Path(path)) for path in snakemake.input.percepts]), condition["D"])
    for figure, channel in CATEGORY_FIGURES.items():
        save_figure(category_crops(fit, channel, seen.crop, shown), *map(Path, snakemake.output[figure]))
