"""Draw the confusion matrices of one method."""

from pathlib import Path

import pandas as pd

from evaluation.confusion import of_method
from evaluation.figures.confusion import confusion_figure
from evaluation.figures.drawing import save_figure
from workflow.execution.job import job

with job(snakemake):
    counts = pd.concat([pd.read_csv(path) for path in snakemake.input], ignore_index=True)
    figure = confusion_figure(of_method(counts, snakemake.wildcards.method), snakemake.params.words)
    save_figure(figure, *map(Path, snakemake.output))
