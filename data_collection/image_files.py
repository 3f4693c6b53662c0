"""Pictures and animations as files, which appear only when they are complete."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from PIL import Image as Pillow

from data_collection.files import replacing
from data_collection.log.messages import Image


def mosaic(rows: Sequence[Iterable[Image]], columns: int, cell: tuple[int, int]) -> Image:
    """Return pictures in rows on white, each at the upper left of a cell of this height and width."""
    height, width = cell
    page = np.full((len(rows) * height, columns * width, 3), 255, dtype=np.uint8)
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            top, left = i * height, j * width
            page[top : top + picture.shape[0], left : left + picture.shape[1]] = picture
    return page


def save_png(path: Path, image: Image) -> None:
    """Write a picture."""
    with replacing(path) as (temporary,):
        Pillow.fromarray(image).save(temporary, format="PNG")


def save_gif(path: Path, frames: Sequence[Image], rate: float, hold: float = 0.0) -> None:
    """Write an animation of `rate` pictures per second, the last of which stays `hold` seconds longer."""
    pictures = [Pillow.fromarray(frame) for frame in frames]
    step = max(20, round(1000.0 / rate))
    durations = [step] * (len(frames) - 1) + [step + round(1000.0 * hold)]
    with replacing(path) as (temporary,):
        pictures[0].save(
            temporary, format="GIF", save_all=True, append_images=pictures[1:], duration=durations, loop=0
        )
