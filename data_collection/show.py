"""A log as pictures: a strip of what the robot saw, and an animation of the robot from outside."""

import math
from collections.abc import Sequence

import numpy as np

from data_collection import task
from data_collection.image_files import mosaic
from data_collection.log import topics
from data_collection.log.mcap_log import Log
from data_collection.log.messages import Image, JointState
from data_collection.log.trial import observation
from data_collection.log.truth import truth
from data_collection.outside import Outside
from data_collection.simulation_settings import Simulation
from data_collection.simulator import scene
from data_collection.simulator.world import World

_GAP = 32
"""Between two trials on a page, pixels."""


def strip(log: Log, only: tuple[bool, bool, bool] = (True, True, True)) -> Image:
    """Return the pictures before, at gaze and after side by side, with trial and sentence written under them.

    Args:
        log: Log of a trial or an instruction.
        only: Which of the three pictures to take.
    """
    from PIL import Image as Pillow
    from PIL import ImageDraw, ImageFont

    seen = observation(log)
    known = truth(log)
    taken = (seen.image_before, seen.image_gaze, seen.image_after)
    pictures = [image for image, wanted in zip(taken, only, strict=True) if wanted and image is not None]
    row = np.hstack(pictures)
    letter = row.shape[0] // 14  # pixels
    canvas = Pillow.new("RGB", (row.shape[1], row.shape[0] + letter * 3 // 2), "white")
    canvas.paste(Pillow.fromarray(row), (0, 0))
    done = "" if known is None else f"   [{known.outcome.get('action', known.action_word)}]"
    text = f"{seen.trial}: {' '.join(seen.words) or '(nothing said)'}{done}"
    at = (letter // 2, row.shape[0] + letter // 8)
    ImageDraw.Draw(canvas).text(at, text, fill="black", font=ImageFont.load_default(size=letter))
    return np.asarray(canvas, dtype=np.uint8)


def animation(log: Log, *, width: int = 480, height: int = 360, every: int = 1) -> list[Image]:
    """Return pictures of robot, table and objects from outside at the logged joint states.

    Objects are drawn where the truth topics have them; without these the robot is alone at its table.

    Args:
        log: Log of a trial.
        width: Columns.
        height: Rows.
        every: Take only every so manieth joint state, and the last.

    Raises:
        LogError: The log is not sound, or is of a simulation with settings that this version does not know.
    """
    observation(log)
    states = [(message.time, message.value) for message in log.messages if message.topic == topics.JOINT_STATES]
    poses = {message.time: message.value for message in log.messages if message.topic == topics.TRUTH_POSES}
    taken = states[::every] + (states[-1:] if (len(states) - 1) % every else [])
    with Outside(log, width, height) as outside:
        return [
            outside.picture(state.position, None if (at := poses.get(time)) is None else np.asarray(at))
            for time, state in taken
            if isinstance(state, JointState)
        ]


def brief(log: Log, pictures: int = 9) -> list[Image]:
    """Return about the given number of pictures of an animation, evenly spaced, the last one included."""
    states = sum(message.topic == topics.JOINT_STATES for message in log.messages)
    return animation(log, width=400, height=300, every=max(1, math.ceil((states - 1) / (pictures - 1))))


def contact_sheet(logs: Sequence[Log], columns: int = 3) -> Image:
    """Return trials on one page: each as the pictures before and after with its sentence."""
    tiles = [strip(log, only=(True, False, True)) for log in logs]
    height = max(tile.shape[0] for tile in tiles)
    width = max(tile.shape[1] for tile in tiles)
    rows = [tiles[first : first + columns] for first in range(0, len(tiles), columns)]
    return mosaic(rows, columns, (height, width + _GAP))[:, :-_GAP]


def gallery(simulation: Simulation, *, width: int = 900, height: int = 420) -> Image:
    """Return a picture of all objects of an experiment on the table (Figure 7 of the paper)."""
    kinds = simulation.kinds()
    columns = math.ceil(len(kinds) / 2)
    aside = 0.06  # metres to the left of the middle, where the right hand at rest is out of the picture
    ys = [aside + 0.09 * ((columns - 1) / 2 - column) for column in range(columns)]
    placed = [
        task.Placed(kind, "", (0.30 + 0.12 * (number // columns), ys[number % columns]), 0.5)
        for number, kind in enumerate(kinds)
    ]
    eye, towards = np.array([0.02, aside, 0.40]), np.array([0.36, aside, simulation.table.height])
    ahead = (towards - eye) / np.linalg.norm(towards - eye)
    with World(simulation) as world:
        world.set_up(placed, None)
        return world.photograph(scene.View(eye, ahead, np.array([0.0, 0.0, 1.0]), width, height, 34.0, near=0.25))
