"""URDF of the iCub used here: the installed `icub-models` robot, amended in memory by a hand and eyes.

Nothing of the package is copied: its URDF is read from where it is installed and changed as a tree. Legs and left
arm are held fixed, sensor frames without a body are dropped, the rigid right hand of the model is replaced by one of
our own with bending fingers (`hand_model`), and the head gets two eyes (tilt, pan left, pan right). Lengths in
metres, angles in radians.
"""

import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from data_collection.simulator.hand_model import add_hand
from data_collection.simulator.urdf import add_joint, add_link, at, find_link, numbers, solid

ICUB_MODEL = "iCubGazeboV2_5"

EYES_LINK = "eyes"
LEFT_EYE_LINK = "l_eye"
EYES_IN_HEAD = (0.0, 0.098, 0.060)
EYE_BASELINE = 0.068

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


def robot_urdf(*, meshes: bool = True, own_view: bool = False) -> str:
    """Return the amended URDF as text with absolute mesh paths.

    Args:
        meshes: False leaves `package://` paths, for logs, which must not hold a machine's paths.
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
    add_hand(robot)
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


def _fix(joint: ElementTree.Element, angle: float) -> None:
    """Turn a revolute joint into a fixed one that stands at `angle`."""
    joint.set("type", "fixed")
    origin, axis = joint.find("origin"), joint.find("axis")
    if angle and origin is not None and axis is not None:
        from scipy.spatial.transform import Rotation

        vector = [angle * float(value) for value in axis.get("xyz", "").split()]
        euler = [float(value) for value in origin.get("rpy", "0 0 0").split()]
        turned = Rotation.from_euler("xyz", euler) * Rotation.from_rotvec(vector)
        origin.set("rpy", numbers(turned.as_euler("xyz").tolist()))


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


def _add_arm_collision(robot: ElementTree.Element) -> None:
    forearm = find_link(robot, "r_forearm")
    collision = ElementTree.SubElement(forearm, "collision")
    collision.append(at((-0.045, 0.0, 0.012), (0.0, math.radians(75) - math.pi, 0.0)))
    collision.append(solid("cylinder", radius=0.028, length=0.11))


def _add_eyes(robot: ElementTree.Element) -> None:
    """Add the eyes: tilt about the axis through both, then each pans about its own upright axis.

    The frames are turned so that x looks ahead, y to the left and z up when all joints of neck and eyes are 0.
    """
    add_link(robot, EYES_LINK, 0.01)
    frame = at(EYES_IN_HEAD, (-math.pi / 2, -math.pi / 2, 0.0))
    add_joint(robot, "eyes_tilt", "head", EYES_LINK, frame, (0.0, -1.0, 0.0), (math.radians(-35), math.radians(15)))
    for name, side in ((LEFT_EYE_LINK, 1.0), ("r_eye", -1.0)):
        ball = (at(), solid("sphere", radius=0.018), _WHITE, False)
        pupil = (at((0.012, 0.0, 0.0)), solid("sphere", radius=0.008), _PUPIL, False)
        add_link(robot, name, 0.01, [ball, pupil])
        origin = at((0.0, side * EYE_BASELINE / 2, 0.0))
        add_joint(
            robot, f"{name}_pan", EYES_LINK, name, origin, (0.0, 0.0, 1.0), (math.radians(-55), math.radians(55))
        )
