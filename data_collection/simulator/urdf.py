"""Pieces of a URDF: links, joints and shapes as elements of an XML tree. Lengths in metres, angles in radians."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence

Shape = tuple[ElementTree.Element, ElementTree.Element, str, bool]
"""Origin, geometry, color, whether it collides."""


def numbers(values: Sequence[float]) -> str:
    """Numbers as an attribute."""
    return " ".join(f"{value:.9g}" for value in values)


def at(xyz: Sequence[float] = (0.0, 0.0, 0.0), rpy: Sequence[float] = (0.0, 0.0, 0.0)) -> ElementTree.Element:
    """The origin of a shape or joint: where it is, and how it is turned (roll, pitch, yaw)."""
    return ElementTree.Element("origin", {"xyz": numbers(xyz), "rpy": numbers(rpy)})


def solid(kind: str, **sizes: float | str) -> ElementTree.Element:
    """The geometry of a shape: `box`, `cylinder` or `sphere` with its sizes."""
    geometry = ElementTree.Element("geometry")
    ElementTree.SubElement(geometry, kind, {name: str(size) for name, size in sizes.items()})
    return geometry


def find_link(robot: ElementTree.Element, name: str) -> ElementTree.Element:
    """The link of this name.

    Raises:
        RuntimeError: There is none.
    """
    link = robot.find(f"link[@name='{name}']")
    if link is None:
        raise RuntimeError(f"link {name} is missing from the iCub model")
    return link


def add_link(
    robot: ElementTree.Element,
    name: str,
    mass: float,
    shapes: Sequence[Shape] = (),
    centre: Sequence[float] = (0.0, 0.0, 0.0),
) -> None:
    """Append a link of a mass (kg) at a centre; it is seen, and felt where its shapes collide."""
    link = ElementTree.SubElement(robot, "link", {"name": name})
    inertial = ElementTree.SubElement(link, "inertial")
    inertial.append(at(centre))
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


def add_joint(
    robot: ElementTree.Element,
    name: str,
    parent: str,
    child: str,
    origin: ElementTree.Element,
    axis: Sequence[float] | None = None,
    limits: tuple[float, float] = (0.0, 0.0),
) -> None:
    """Append a revolute joint, or a fixed one when `axis` is None."""
    joint = ElementTree.SubElement(robot, "joint", {"name": name, "type": "fixed" if axis is None else "revolute"})
    joint.append(origin)
    ElementTree.SubElement(joint, "parent", {"link": parent})
    ElementTree.SubElement(joint, "child", {"link": child})
    if axis is not None:
        ElementTree.SubElement(joint, "axis", {"xyz": numbers(axis)})
        bounds = {"lower": f"{limits[0]:.9g}", "upper": f"{limits[1]:.9g}", "effort": "50", "velocity": "10"}
        ElementTree.SubElement(joint, "limit", bounds)
