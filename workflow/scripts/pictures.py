"""Show an experiment: its first trials before and after the action, and its objects."""

from pathlib import Path

from data_collection.mcap_log import read_log
from data_collection.settings import Simulation
from data_collection.show import contact_sheet, gallery, save_png
from workflow.job import job

with job(snakemake.log[0]):
    logs = [read_log(Path(path)) for path in snakemake.input]
    save_png(Path(snakemake.output.trials), contact_sheet(logs))
    save_png(Path(snakemake.output.objects), gallery(Simulation.from_mapping(snakemake.params.simulation)))
