"""Count which words are confused in the descriptions of one experiment and D."""

from pathlib import Path

import pandas as pd

from evaluation.confusion import count_confusions
from evaluation.scores import write_csv
from workflow.execution.job import job

with job(snakemake):
    described = pd.read_csv(snakemake.input[0])
    write_csv(count_confusions(described, snakemake.params.words), Path(snakemake.output[0]))
