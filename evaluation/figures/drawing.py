"""What all figures share: their width and style, and how they are saved."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image as Pillow

from data_collection.files import replacing
from data_collection.image_files import save_gif, save_png
from data_collection.log.messages import Image
from evaluation.figures.fonts import every_script

PAGE_WIDTH = 7.0
"""Width of a figure, inches; at this width no letter is smaller than 7 points."""
DPI = 180
STYLE: Any = {
    "font.size": 8,
    "axes.titlesize": 9,
    "figure.titlesize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    # Text stays text, so that a PDF can be searched.
    "pdf.fonttype": 42,
    # A word with two dollar signs is no formula.
    "text.parse_math": False,
}


@contextmanager
def page(height: float, title: str = "", width: float = PAGE_WIDTH) -> Iterator[Figure]:
    """A figure of this size, inches, with this heading; what is drawn within the block has the common style."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        if title:
            figure.suptitle(title)
        yield figure


def picture(image: Image) -> Figure:
    """A figure that is one image, (H, W, 3) RGB, over the whole width of a page."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(PAGE_WIDTH, PAGE_WIDTH * image.shape[0] / image.shape[1]))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.imshow(coarse(image))
    return figure


@dataclass(frozen=True)
class Animation:
    """Pictures one after the other.

    Attributes:
        frames: The pictures.
        rate: Pictures per second.
        hold: Seconds that the last one stays longer.
    """

    frames: list[Image]
    rate: float
    hold: float


def save(drawn: Figure | Animation | Image, *paths: Path) -> None:
    """Write what was drawn: a figure in the form of each path, a picture as PNG, an animation as GIF."""
    if isinstance(drawn, Figure):
        save_figure(drawn, *paths)
    elif isinstance(drawn, Animation):
        save_gif(paths[0], drawn.frames, drawn.rate, drawn.hold)
    else:
        save_png(paths[0], drawn)


def save_figure(figure: Figure, *paths: Path) -> None:
    """Write a figure as PNG or PDF, by the ending of each path; the same figure gives the same bytes.

    A PNG has 64 shades of each of red, green and blue: nobody sees the difference, but noise in photographs takes
    half the room.
    """
    with every_script(figure):
        for path in paths:
            with replacing(path) as (temporary,):
                if path.suffix == ".pdf":
                    figure.savefig(temporary, dpi=DPI, format="pdf", metadata={"CreationDate": None})
                    continue
                drawn = BytesIO()
                figure.savefig(drawn, dpi=DPI, format="png")
                shades = coarse(np.asarray(Pillow.open(drawn).convert("RGB")))
                Pillow.fromarray(shades).save(temporary, format="PNG", optimize=True)


def coarse(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """An image with 64 shades a channel, black and white kept."""
    return np.rint(np.rint(image / 255.0 * 63.0) / 63.0 * 255.0).astype(np.uint8)
