"""Draw what the most probable fit of a condition has learned."""

from pathlib import Path

from evaluation.figures import position_categories, save_figure, word_distributions
from model import METHODS, load
from workflow.job import job

with job(snakemake):
    fits = [load(Path(path)) for path in snakemake.input.fits]
    best = max(range(len(fits)), key=lambda i: float(fits[i].trace_log_joint[-1]))
    shown = snakemake.params.condition
    title = (
        f"{shown['experiment']}, {METHODS[shown['method']].label}, D = {shown['D']}, ROW {shown['ROW']} %,\n"
        f"seed {best + 1} of {len(fits)} (highest log joint)"
    )
    save_figure(word_distributions(fits[best], snakemake.params.words, title), Path(snakemake.output.words))
    save_figure(position_categories(fits[best], title), Path(snakemake.output.positions))
