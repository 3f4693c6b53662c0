"""Count which words are confused in the descriptions of one experiment and D."""

from pathlib import Path

from evaluation.confusion import count_confusions
from evaluation.description import read_descriptions
from evaluation.scores import write_csv
from workflow.execution.job import job

with job(snakemake):
    described = read_descriptions([Path(snakemake.input[0])])
    write_csv(count_confusions(described, snakemake.params.words), Path(snakemake.output[0]))
