"""The right hand that the robot is given: five bending fingers, 14 revolute joints that 9 logged joints drive.

Palm frame (`r_palm`): origin in the middle of the palm, x along the stretched fingers, z out of the palm, and y
towards the little finger (the iCub's own Denavit–Hartenberg frame of the right hand).
"""

import math
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

from data_collection.simulator.urdf import Shape, add_joint, add_link, at, find_link, numbers, solid

PALM_LINK = "r_palm"
GRASP_LINK = "r_grasp"
SKIN = "0.88 0.86 0.82 1"
DARK = "0.25 0.25 0.28 1"


@dataclass(frozen=True)
class Finger:
    """One finger of the right hand in the palm frame.

    Attributes:
        name: `thumb`, `index`, `middle`, `ring` or `little`.
        base: Where its first joint sits, metres.
        direction: Angle in the palm's plane from x towards −y (the thumb's side), radians.
        lengths: Of the proximal and the distal phalanx, metres.
        spread_axis: Axis of its first joint, or None when it has none.
        spread_limit: Largest angle of that joint, radians.
    """

    name: str
    base: tuple[float, float, float]
    direction: float
    lengths: tuple[float, float]
    spread_axis: tuple[float, float, float] | None
    spread_limit: float


# Finger lengths and limits follow left_hand_mk3 of icub-models (proximal 30 mm, thumb shorter).
FINGERS = (
    Finger("thumb", (-0.046, -0.018, 0.004), math.radians(97), (0.026, 0.022), (-1.0, 0.0, 0.0), math.radians(110)),
    Finger("index", (0.032, -0.025, 0.0), 0.0, (0.034, 0.030), (0.0, 0.0, -1.0), math.radians(15)),
    Finger("middle", (0.034, -0.008, 0.0), 0.0, (0.036, 0.032), None, 0.0),
    Finger("ring", (0.032, 0.009, 0.0), 0.0, (0.034, 0.030), (0.0, 0.0, 1.0), math.radians(8)),
    Finger("little", (0.028, 0.025, 0.0), 0.0, (0.028, 0.026), (0.0, 0.0, 1.0), math.radians(15)),
)
FINGER_RADIUS = 0.0075
PALM_SIZE = (0.090, 0.068, 0.024)
PALM_CENTRE = (-0.013, 0.0, -0.004)
GRASP_CENTRE = (0.002, 0.0, 0.040)
"""Middle of what the closed hand holds, in the palm frame: what the arm brings to its target."""

TIP_REACH = FINGERS[0].base[2] + sum(FINGERS[0].lengths) + FINGER_RADIUS - GRASP_CENTRE[2]
"""How far the opposed thumb reaches below the grasp point when the palm looks down, metres."""

BEND_LIMIT = math.radians(90)

PALM_DEPTH = GRASP_CENTRE[2] - PALM_CENTRE[2] - PALM_SIZE[2] / 2
"""From the skin of the palm to the grasp point, metres."""


def _capsule(length: float, radius: float, color: str) -> list[Shape]:
    """Shapes of a phalanx along x: a cylinder with a ball at either end."""
    cylinder = solid("cylinder", radius=radius, length=length)
    ball = solid("sphere", radius=radius)
    return [
        (at((length / 2, 0.0, 0.0), (0.0, math.pi / 2, 0.0)), cylinder, color, True),
        (at((length, 0.0, 0.0)), ball, color, True),
        (at(), solid("sphere", radius=radius * 1.05), DARK, False),
    ]


def add_hand(robot: ElementTree.Element) -> None:
    """Put the hand in the place of the rigid one of the model."""
    rigid = find_link(robot, "r_hand")
    for visual in rigid.findall("visual"):
        rigid.remove(visual)
    palm = (at(PALM_CENTRE), solid("box", size=numbers(PALM_SIZE)), SKIN, True)
    across = at((-0.062, 0.0, -0.003), (0.0, math.pi / 2, 0.0))
    wrist = (across, solid("cylinder", radius=0.02, length=0.03), DARK, False)
    add_link(robot, PALM_LINK, 0.15, [palm, wrist])
    palm_frame = at((-0.05765429784, -0.0055568, 0.01369383231), (-math.pi / 2, -math.radians(15), math.pi))
    add_joint(robot, "r_palm_fixed", "r_hand", PALM_LINK, palm_frame)
    add_link(robot, GRASP_LINK, 0.001)
    add_joint(robot, "r_grasp_fixed", PALM_LINK, GRASP_LINK, at(GRASP_CENTRE))
    for finger in FINGERS:
        _add_finger(robot, finger)


def _add_finger(robot: ElementTree.Element, finger: Finger) -> None:
    thumb = finger.name == "thumb"
    straight, turned = (0.0, 0.0, 0.0), (0.0, 0.0, -finger.direction)
    parent, origin = PALM_LINK, at(finger.base, turned)
    if finger.spread_axis is not None:
        parent = f"r_{finger.name}_knuckle"
        add_link(robot, parent, 0.01, [(at(), solid("sphere", radius=FINGER_RADIUS * 1.1), DARK, False)])
        # Opposition turns about the palm's x: the joint's frame is the palm's, the direction follows after it.
        name, before, after = ("oppose", straight, turned) if thumb else ("spread", turned, straight)
        frame, limits = at(finger.base, before), (0.0, finger.spread_limit)
        add_joint(robot, f"r_{finger.name}_{name}", PALM_LINK, parent, frame, finger.spread_axis, limits)
        origin = at(rpy=after)
    # The fingers bend out of the palm's plane; the thumb bends in it, so that once opposed it closes on them.
    axis = (0.0, 0.0, 1.0) if thumb else (0.0, -1.0, 0.0)
    proximal, distal = f"r_{finger.name}_proximal_phalanx", f"r_{finger.name}_distal_phalanx"
    add_link(robot, proximal, 0.02, _capsule(finger.lengths[0], FINGER_RADIUS, SKIN), (finger.lengths[0] / 2, 0, 0))
    add_joint(robot, f"r_{finger.name}_proximal", parent, proximal, origin, axis, (0.0, BEND_LIMIT))
    tip = _capsule(finger.lengths[1], FINGER_RADIUS * 0.95, SKIN)
    add_link(robot, distal, 0.015, tip, (finger.lengths[1] / 2, 0, 0))
    knuckle = at((finger.lengths[0], 0.0, 0.0))
    add_joint(robot, f"r_{finger.name}_distal", proximal, distal, knuckle, axis, (0.0, BEND_LIMIT))
