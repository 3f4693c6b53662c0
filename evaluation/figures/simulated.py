"""What an experiment looks like: its first trials, and its objects."""

from __future__ import annotations

import cv2
import numpy as np
from matplotlib.figure import Figure

from data_collection.log.mcap_log import read_log
from data_collection.log.messages import Image
from data_collection.show import contact_sheet, gallery
from data_collection.simulation_settings import Simulation
from evaluation.figures.drawing import coarse, picture
from evaluation.figures.source import Source


def trials(source: Source) -> Image:
    """Trials before and after the action.

    Noisy pictures are large as PNG; half the size and fewer shades still show hand, objects and words.
    """
    sheet = contact_sheet([read_log(path) for path in source.files["logs"]])
    size = (sheet.shape[1] // 2, sheet.shape[0] // 2)
    return coarse(np.asarray(cv2.resize(sheet, size, interpolation=cv2.INTER_AREA), np.uint8))


def objects(source: Source) -> Figure:
    """All objects on the table."""
    return picture(gallery(Simulation.model_validate(source.settings["simulation"])))
