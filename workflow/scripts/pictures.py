"""Show an experiment: its first trials before and after the action, and its objects."""

from pathlib import Path

import cv2

from data_collection.log.mcap_log import read_log
from data_collection.show import contact_sheet, gallery, save_png
from data_collection.simulation_settings import Simulation
from evaluation.figures.drawing import coarse, picture, save_figure
from workflow.execution.job import job

with job(snakemake):
    logs = [read_log(Path(path)) for path in snakemake.input]
    sheet = contact_sheet(logs)
    # Noisy pictures are large as PNG; half the size and fewer shades still show hand, objects and words.
    half = cv2.resize(sheet, (sheet.shape[1] // 2, sheet.shape[0] // 2), interpolation=cv2.INTER_AREA)
    save_png(Path(snakemake.output.trials), coarse(half))
    objects = gallery(Simulation.model_validate(snakemake.params.simulation))
    save_figure(picture(objects), *map(Path, snakemake.output.objects))
