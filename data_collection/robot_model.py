"""URDF of the iCub used here: the installed ``icub-models`` robot, amended in memory by a hand and eyes.

Nothing of the package is copied: its URDF is read from where it is installed and changed as a tree. Legs and left
arm are held fixed, sensor frames without a body are dropped, and the rigid right hand of the model is replaced
by one of our own with five bending fingers (14 revolute joints that 9 logged joints drive) and the head gets two
eyes (tilt, pan left, pan right). Lengths in metres, angles in radians.

Palm frame (``r_palm``): origin in the middle of the palm, x along the stretched fingers, z out of the palm, and y
towards the little finger (the iCub's own Denavit–Hartenberg frame of the right hand).
"""

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

ICUB_MODEL = "iCubGazeboV2_5"

PALM_LINK = "r_palm"
GRASP_LINK = "r_grasp"
EYES_LINK = "eyes"
LEFT_EYE_LINK = "l_eye"

_SKIN = "0.88 0.86 0.82 1"
_DARK = "0.25 0.25 0.28 1"
_WHITE = "0.97 0.97 0.97 1"
_PUPIL = "0.08 0.08 0.10 1"

# Left arm and legs do not take part: fixed at these angles (degrees); joints that are not named stay at 0.
_FIXED_POSTURE = {"l_shoulder_pitch": 8.0, "l_shoulder_roll": 18.0, "l_elbow": 40.0}
_FIXED_PREFIXES = ("l_shoulder", "l_elbow", "l_wrist", "l_hip", "l_knee", "l_ankle", "r_hip", "r_knee", "r_ankle")
_OUT_OF_VIEW = (
    "root",
    "torso",
    "neck",
    "head",
    "eyes",
    "l_",
    "r_hip",
    "r_upper_leg",
    "r_lower_leg",
    "r_ankle",
    "r_foot",
    "r_eye",
)


@dataclass(frozen=True)
class Finger:
    """One finger of the right hand in the palm frame.

    Attributes:
        name: ``thumb``, ``index``, ``middle``, ``ring`` or ``little``.
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
    Finger("thumb", (-0.046, -0.018, 0.004), math.radians(97), (0.026, 0.022), (1.0, 0.0, 0.0), math.radians(110)),
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


def urdf(*, meshes: bool = True, own_view: bool = False) -> str:
    """Return the amended URDF as text with absolute mesh paths.

    Args:
        meshes: False leaves ``package://`` paths, for logs, which must not hold a machine's paths.
        own_view: True leaves undrawn what its own eyes do not look at (head, legs, left arm): quick to render.

    Raises:
        RuntimeError: The installed model has not the joints or links that the amendments need.
    """
    import icub_models

    path = Path(str(icub_models.get_model_file(ICUB_MODEL)))
    robot = ElementTree.parse(path).getroot()
    _check(robot, path)
    for joint in robot.findall("joint"):
        name = joint.get("name", "")
        if name.startswith(_FIXED_PREFIXES):
            _fix(joint, math.radians(_FIXED_POSTURE.get(name, 0.0)))
    _drop_bare_links(robot)
    for link in robot.findall("link"):
        for collision in link.findall("collision"):
            link.remove(collision)
    _add_arm_collision(robot)
    _add_hand(robot)
    _add_eyes(robot)
    if own_view:
        for link in robot.findall("link"):
            if link.get("name", "").startswith(_OUT_OF_VIEW):
                for visual in link.findall("visual"):
                    link.remove(visual)
    if meshes:
        share = str(path.parents[3])
        for mesh in robot.iter("mesh"):
            mesh.set("filename", mesh.get("filename", "").replace("package:/", share, 1))
    ElementTree.indent(robot)  # PyBullet breaks lines of more than about a thousand characters, even inside a name
    return ElementTree.tostring(robot, encoding="unicode")


def _check(robot: ElementTree.Element, path: Path) -> None:
    names = {element.get("name") for element in robot}
    missing = {"root_link", "chest", "head", "r_forearm", "r_hand", "r_wrist_yaw", "neck_yaw", "torso_pitch"} - names
    if missing:
        raise RuntimeError(f"{path.name} of icub-models lacks {sorted(str(name) for name in missing)}")


def _text(values: Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _origin(xyz: Sequence[float], rpy: Sequence[float] = (0.0, 0.0, 0.0)) -> ElementTree.Element:
    return ElementTree.Element("origin", {"xyz": _text(xyz), "rpy": _text(rpy)})


def _geometry(kind: str, **sizes: str) -> ElementTree.Element:
    geometry = ElementTree.Element("geometry")
    ElementTree.SubElement(geometry, kind, sizes)
    return geometry


def _fix(joint: ElementTree.Element, angle: float) -> None:
    """Turn a revolute joint into a fixed one that stands at ``angle``."""
    joint.set("type", "fixed")
    origin, axis = joint.find("origin"), joint.find("axis")
    if angle and origin is not None and axis is not None:
        from scipy.spatial.transform import Rotation

        vector = [angle * float(value) for value in axis.get("xyz", "").split()]
        euler = [float(value) for value in origin.get("rpy", "0 0 0").split()]
        turned = Rotation.from_euler("xyz", euler) * Rotation.from_rotvec(vector)
        origin.set("rpy", _text(turned.as_euler("xyz").tolist()))


def _drop_bare_links(robot: ElementTree.Element) -> None:
    """Drop sensor frames: leaves on fixed joints that have no geometry, again and again until none is left."""
    while True:
        parents = {element.get("link") for element in robot.iter("parent")}
        bare = {
            link.get("name")
            for link in robot.findall("link")
            if link.find("visual") is None and link.get("name") not in parents
        }
        if not bare:
            return
        for link in [link for link in robot.findall("link") if link.get("name") in bare]:
            robot.remove(link)
        for joint in robot.findall("joint"):
            child = joint.find("child")
            if child is not None and child.get("link") in bare:
                robot.remove(joint)


def _link(robot: ElementTree.Element, name: str) -> ElementTree.Element:
    link = robot.find(f"link[@name='{name}']")
    if link is None:
        raise RuntimeError(f"link {name} is missing from the iCub model")
    return link


def _add_arm_collision(robot: ElementTree.Element) -> None:
    forearm = _link(robot, "r_forearm")
    collision = ElementTree.SubElement(forearm, "collision")
    collision.append(_origin((-0.045, 0.0, 0.012), (0.0, math.radians(75) - math.pi, 0.0)))
    collision.append(_geometry("cylinder", radius="0.028", length="0.11"))


def _add_link(
    robot: ElementTree.Element,
    name: str,
    mass: float,
    shapes: Sequence[tuple[ElementTree.Element, ElementTree.Element, str, bool]] = (),
    centre: Sequence[float] = (0.0, 0.0, 0.0),
) -> None:
    """Append a link with shapes (origin, geometry, color, whether it collides)."""
    link = ElementTree.SubElement(robot, "link", {"name": name})
    inertial = ElementTree.SubElement(link, "inertial")
    inertial.append(_origin(centre))
    ElementTree.SubElement(inertial, "mass", {"value": f"{mass:.6g}"})
    moment = f"{mass * 4e-4:.6g}"
    ElementTree.SubElement(
        inertial, "inertia", {"ixx": moment, "iyy": moment, "izz": moment, "ixy": "0", "ixz": "0", "iyz": "0"}
    )
    for number, (origin, geometry, color, collides) in enumerate(shapes):
        visual = ElementTree.SubElement(link, "visual")
        visual.extend((origin, geometry))
        material = ElementTree.SubElement(visual, "material", {"name": f"{name}_{number}"})
        ElementTree.SubElement(material, "color", {"rgba": color})
        if collides:
            ElementTree.SubElement(link, "collision").extend((origin, geometry))


def _add_joint(
    robot: ElementTree.Element,
    name: str,
    parent: str,
    child: str,
    origin: ElementTree.Element,
    axis: Sequence[float] | None = None,
    limits: tuple[float, float] = (0.0, 0.0),
) -> None:
    """Append a revolute joint, or a fixed one when ``axis`` is None."""
    joint = ElementTree.SubElement(robot, "joint", {"name": name, "type": "fixed" if axis is None else "revolute"})
    joint.append(origin)
    ElementTree.SubElement(joint, "parent", {"link": parent})
    ElementTree.SubElement(joint, "child", {"link": child})
    if axis is not None:
        ElementTree.SubElement(joint, "axis", {"xyz": _text(axis)})
        bounds = {"lower": f"{limits[0]:.9g}", "upper": f"{limits[1]:.9g}", "effort": "50", "velocity": "10"}
        ElementTree.SubElement(joint, "limit", bounds)


def _capsule(
    length: float, radius: float, color: str
) -> list[tuple[ElementTree.Element, ElementTree.Element, str, bool]]:
    """Shapes of a phalanx along x: a cylinder with a ball at either end."""
    cylinder = _geometry("cylinder", radius=f"{radius}", length=f"{length}")
    ball = _geometry("sphere", radius=f"{radius}")
    return [
        (_origin((length / 2, 0.0, 0.0), (0.0, math.pi / 2, 0.0)), cylinder, color, True),
        (_origin((length, 0.0, 0.0)), ball, color, True),
        (_origin((0.0, 0.0, 0.0)), _geometry("sphere", radius=f"{radius * 1.05}"), _DARK, False),
    ]


def _add_hand(robot: ElementTree.Element) -> None:
    hand = _link(robot, "r_hand")
    for visual in hand.findall("visual"):
        hand.remove(visual)
    palm = (_origin(PALM_CENTRE), _geometry("box", size=_text(PALM_SIZE)), _SKIN, True)
    wrist = (
        _origin((-0.062, 0.0, -0.003), (0.0, math.pi / 2, 0.0)),
        _geometry("cylinder", radius="0.02", length="0.03"),
        _DARK,
        False,
    )
    _add_link(robot, PALM_LINK, 0.15, [palm, wrist])
    palm_frame = _origin((-0.05765429784, -0.0055568, 0.01369383231), (-math.pi / 2, -math.radians(15), math.pi))
    _add_joint(robot, "r_palm_fixed", "r_hand", PALM_LINK, palm_frame)
    _add_link(robot, GRASP_LINK, 0.001)
    _add_joint(robot, "r_grasp_fixed", PALM_LINK, GRASP_LINK, _origin(GRASP_CENTRE))
    for finger in FINGERS:
        _add_finger(robot, finger)


def _add_finger(robot: ElementTree.Element, finger: Finger) -> None:
    parent, origin = PALM_LINK, _origin(finger.base, (0.0, 0.0, -finger.direction))
    if finger.spread_axis is not None:
        knuckle = f"r_{finger.name}_knuckle"
        ball = (_origin((0.0, 0.0, 0.0)), _geometry("sphere", radius=f"{FINGER_RADIUS * 1.1}"), _DARK, False)
        _add_link(robot, knuckle, 0.01, [ball])
        if finger.name == "thumb":
            # Opposition turns about the palm's x: the joint's frame is the palm's, the direction follows after it.
            _add_joint(
                robot,
                "r_thumb_oppose",
                PALM_LINK,
                knuckle,
                _origin(finger.base),
                (-1.0, 0.0, 0.0),
                (0.0, finger.spread_limit),
            )
            origin = _origin((0.0, 0.0, 0.0), (0.0, 0.0, -finger.direction))
        else:
            _add_joint(
                robot,
                f"r_{finger.name}_spread",
                PALM_LINK,
                knuckle,
                origin,
                finger.spread_axis,
                (0.0, finger.spread_limit),
            )
            origin = _origin((0.0, 0.0, 0.0))
        parent = knuckle
    # The fingers bend out of the palm's plane; the thumb bends in it, so that once opposed it closes on them.
    axis = (0.0, 0.0, 1.0) if finger.name == "thumb" else (0.0, -1.0, 0.0)
    proximal, distal = f"r_{finger.name}_proximal_phalanx", f"r_{finger.name}_distal_phalanx"
    _add_link(robot, proximal, 0.02, _capsule(finger.lengths[0], FINGER_RADIUS, _SKIN), (finger.lengths[0] / 2, 0, 0))
    _add_joint(robot, f"r_{finger.name}_proximal", parent, proximal, origin, axis, (0.0, BEND_LIMIT))
    tip = _capsule(finger.lengths[1], FINGER_RADIUS * 0.95, _SKIN)
    _add_link(robot, distal, 0.015, tip, (finger.lengths[1] / 2, 0, 0))
    _add_joint(
        robot,
        f"r_{finger.name}_distal",
        proximal,
        distal,
        _origin((finger.lengths[0], 0.0, 0.0)),
        axis,
        (0.0, BEND_LIMIT),
    )


def _add_eyes(robot: ElementTree.Element) -> None:
    """Add the eyes: tilt about the axis through both, then each pans about its own upright axis.

    The frames are turned so that x looks ahead, y to the left and z up when all joints of neck and eyes are 0.
    """
    _add_link(robot, EYES_LINK, 0.01)
    frame = _origin(EYES_IN_HEAD, (-math.pi / 2, -math.pi / 2, 0.0))
    _add_joint(robot, "eyes_tilt", "head", EYES_LINK, frame, (0.0, -1.0, 0.0), (math.radians(-35), math.radians(15)))
    for name, side in ((LEFT_EYE_LINK, 1.0), ("r_eye", -1.0)):
        ball = (_origin((0.0, 0.0, 0.0)), _geometry("sphere", radius="0.018"), _WHITE, False)
        pupil = (_origin((0.012, 0.0, 0.0)), _geometry("sphere", radius="0.008"), _PUPIL, False)
        _add_link(robot, name, 0.01, [ball, pupil])
        origin = _origin((0.0, side * EYE_BASELINE / 2, 0.0))
        _add_joint(
            robot, f"{name}_pan", EYES_LINK, name, origin, (0.0, 0.0, 1.0), (math.radians(-55), math.radians(55))
        )


EYES_IN_HEAD = (0.0, 0.098, 0.060)
EYE_BASELINE = 0.068
