"""Count which words are confused in the descriptions of one experiment and D."""

from evaluation.confusion import count_confusions
from evaluation.description import read_descriptions
from evaluation.scores import write_csv
from workflow.execution.job import job

with job(snakemake) as (files, out):
    described = read_descriptions(files)
    write_csv(count_confusions(described, snakemake.params.words), out[0])
