"""Say of each condition whether its chains have converged, and how its fits stand beside the truth."""

from evaluation.convergence import beside_truth, lights, read_diagnoses
from evaluation.pages.lights import write_lights
from evaluation.scores import read_scores, write_csv
from workflow.execution.job import job

with job(snakemake) as (files, out):
    diagnoses = read_diagnoses(files.chains)
    found = beside_truth(lights(diagnoses), read_scores([files.scores]))
    write_csv(diagnoses, out.diagnostics)
    write_csv(found, out.convergence)
    write_lights(found, out.page)
