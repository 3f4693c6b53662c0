"""Pictures and animations as files, which appear only when they are complete."""

from collections.abc import Sequence
from pathlib import Path

from PIL import Image as Pillow

from data_collection.files import replacing
from data_collection.log.messages import Image


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
