"""Procedural meshes of the objects: vertices, triangles and normals, as arrays. Lengths in metres, z up.

Every shape stands on z = 0 with its centre at x = y = 0.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Mesh:
    """Triangles with flat normals.

    Attributes:
        vertices: (3 T, 3) corners, three a triangle.
        normals: (3 T, 3) unit vectors outwards.
        tone: Factor in 0..1 on the object's color (dark tyres, windows).
    """

    vertices: Floats
    normals: Floats
    tone: float = 1.0


@dataclass(frozen=True)
class Shape:
    """What an object looks like and how it collides.

    Attributes:
        meshes: Parts that are drawn.
        height: Metres from the table to its top.
        radius: Of the circle on the table around it, metres.
        collision: `box`, `sphere` or `hull` (convex hull of the meshes).
        extents: Full sizes along x, y, z, metres.
    """

    meshes: tuple[Mesh, ...]
    height: float
    radius: float
    collision: str
    extents: tuple[float, float, float]


def _mesh(triangles: Floats, tone: float = 1.0, smooth: Floats | None = None) -> Mesh:
    corners = triangles.reshape(-1, 3, 3)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    keep = lengths[:, 0] > 1e-12
    flat = np.repeat(normals[keep] / lengths[keep], 3, axis=0)
    vertices = corners[keep].reshape(-1, 3)
    if smooth is not None:
        flat = vertices - smooth
        flat = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    return Mesh(vertices, flat, tone)


def _quads(grid: Floats) -> Floats:
    """Return the triangles of a (R, C, 3) grid of points as (T, 3, 3), facing right-handed."""
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    first = np.stack([a, b, c], axis=2).reshape(-1, 3, 3)
    second = np.stack([a, c, d], axis=2).reshape(-1, 3, 3)
    return np.concatenate([first, second])


def sheet(side: float, tiles: int) -> Mesh:
    """Return a level square of `side` metres about the origin, seen from above, of `tiles` times `tiles` squares.

    A renderer that looks at every pixel around a triangle is quicker with a few dozen than with two.
    """
    at = np.linspace(-side / 2, side / 2, tiles + 1)
    x, y = np.meshgrid(at, at, indexing="ij")
    return _mesh(_quads(np.stack([x, y, np.zeros_like(x)], axis=2)))


def revolve(profile: Floats, segments: int = 32) -> Floats:
    """Return the triangles of a profile of (radius, z), from bottom to top outside, turned about z."""
    angles = np.linspace(0.0, 2 * np.pi, segments + 1)
    x = profile[:, 0:1] * np.cos(angles)
    y = profile[:, 0:1] * np.sin(angles)
    z = np.repeat(profile[:, 1:2], len(angles), axis=1)
    return _quads(np.stack([x, y, z], axis=2).transpose(1, 0, 2))


def extrude(outline: Floats, bottom: float, top: float) -> Floats:
    """Return the triangles of a counter-clockwise outline (P, 2), star-shaped about its mean, between two heights."""
    closed = np.vstack([outline, outline[:1]])
    low = np.column_stack([closed, np.full(len(closed), bottom)])
    high = np.column_stack([closed, np.full(len(closed), top)])
    walls = _quads(np.stack([low, high], axis=1))
    centre = outline.mean(axis=0)
    cap = [[(*centre, top), high[i], high[i + 1]] for i in range(len(outline))]
    base = [[(*centre, bottom), low[i + 1], low[i]] for i in range(len(outline))]
    return np.concatenate([walls, np.array(cap), np.array(base)])


def cuboid(centre: tuple[float, float, float], size: tuple[float, float, float]) -> Floats:
    """Return the 12 triangles of a box."""
    x, y = size[0] / 2, size[1] / 2
    outline = np.array([[-x, -y], [x, -y], [x, y], [-x, y]]) + np.array(centre[:2])
    return extrude(outline, centre[2] - size[2] / 2, centre[2] + size[2] / 2)


def _wheel(x: float, y: float, radius: float, width: float) -> Floats:
    profile = np.array([[0.0, -width / 2], [radius, -width / 2], [radius, width / 2], [0.0, width / 2]])
    turned = revolve(profile, 20)
    return np.stack([turned[..., 0] + x, -turned[..., 2] + y, turned[..., 1] + radius], axis=-1)


def _shape(meshes: tuple[Mesh, ...], collision: str) -> Shape:
    points = np.concatenate([mesh.vertices for mesh in meshes])
    extents = points.max(axis=0) - points.min(axis=0)
    radius = float(np.hypot(points[:, 0], points[:, 1]).max())
    return Shape(meshes, float(points[:, 2].max()), radius, collision, (extents[0], extents[1], extents[2]))


def box(size: float, height: float, style: int) -> Shape:
    """Return a square block; `style` is not used."""
    return _shape((_mesh(cuboid((0.0, 0.0, height / 2), (size, size, height))),), "box")


def ball(size: float, height: float, style: int) -> Shape:
    """Return a ball of diameter `size`; height and style are not used."""
    radius = size / 2
    angle = np.linspace(-np.pi / 2, np.pi / 2, 19)
    profile = np.column_stack([radius * np.cos(angle), radius + radius * np.sin(angle)])
    profile[[0, -1], 0] = 0.0
    return _shape((_mesh(revolve(profile, 36), smooth=np.array([0.0, 0.0, radius])),), "sphere")


def cup(size: float, height: float, style: int) -> Shape:
    """Return an open cup of upper diameter `size`, a little narrower at its foot; style 1 and 2 have a handle."""
    top, wall = size / 2, 0.004
    foot = 0.78 * top
    outside = [[0.0, 0.0], [foot, 0.0], [top, height]]
    inside = [[top - wall, height], [foot - wall, 0.012], [0.0, 0.012]]
    body = _mesh(revolve(np.array(outside)))
    lip = _mesh(revolve(np.array([[top, height], [top - wall, height]])))
    hollow = _mesh(revolve(np.array(inside)), tone=0.55)
    meshes = [body, lip, hollow]
    if style > 0:
        angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 13)
        around = np.linspace(0.0, 2 * np.pi, 9)
        reach, rise, thick = 0.22 * size, 0.28 * height, 0.005
        ring = np.stack(
            [
                0.86 * top + np.cos(angle)[:, None] * (reach + thick * np.cos(around)),
                np.repeat((thick * np.sin(around))[None], len(angle), axis=0),
                0.55 * height + np.sin(angle)[:, None] * (rise + thick * np.cos(around)),
            ],
            axis=2,
        )
        meshes.append(_mesh(_quads(ring)))
    return _shape(tuple(meshes), "hull")


def car(size: float, height: float, style: int) -> Shape:
    """Return a toy car of length `size` with wheels; `style` chooses hatchback, van, pick-up or racer."""
    body_height, cabin_length, cabin_at, taper = (
        (0.50, 0.52, -0.05, 0.75),
        (0.42, 0.80, -0.06, 0.94),
        (0.52, 0.32, 0.12, 0.90),
        (0.45, 0.30, -0.15, 0.55),
    )[style % 4]
    wheel = 0.20 * height if style % 4 != 2 else 0.24 * height
    width = 0.56 * size if style % 4 != 3 else 0.50 * size
    waist = wheel + body_height * (height - wheel)
    body = cuboid((0.0, 0.0, (0.6 * wheel + waist) / 2), (size, width, waist - 0.6 * wheel))
    low, high = cabin_length * size / 2, taper * cabin_length * size / 2
    middle, side = cabin_at * size, 0.45 * width
    ring = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    bottom = np.column_stack([middle + ring[:, 0] * low, ring[:, 1] * side, np.full(5, waist)])
    top = np.column_stack([middle + ring[:, 0] * high, ring[:, 1] * side * 0.88, np.full(5, height)])
    roof = np.array([[top[0], top[1], top[2]], [top[0], top[2], top[3]]])
    cabin = np.concatenate([_quads(np.stack([bottom, top], axis=1)), roof])
    wheels = [_wheel(x * size, y * width / 2, wheel, 0.012) for x in (-0.30, 0.30) for y in (-0.95, 0.95)]
    band = 1.012
    glass_low, glass_high = bottom + 0.25 * (top - bottom), bottom + 0.80 * (top - bottom)
    centre = np.array([middle, 0.0, 0.0])
    glass = [(points - centre) * np.array([band, band, 1.0]) + centre for points in (glass_low, glass_high)]
    windows = _quads(np.stack(glass, axis=1))
    parts = (
        _mesh(np.concatenate([body, cabin])),
        _mesh(np.concatenate(wheels), tone=0.15),
        _mesh(windows, tone=0.30),
    )
    return _shape(parts, "hull")


def star(size: float, height: float, style: int) -> Shape:
    """Return a flat star of outer diameter `size` with 5 points; style 1 has 6 and is fatter."""
    points, inner = (5, 0.45) if style == 0 else (6, 0.62)
    angle = np.arange(2 * points) * np.pi / points
    radius = np.where(np.arange(2 * points) % 2 == 0, size / 2, inner * size / 2)
    outline = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    return _shape((_mesh(extrude(outline, 0.0, height)),), "hull")


BUILDERS: Mapping[str, Callable[[float, float, int], Shape]] = {
    "box": box,
    "cup": cup,
    "ball": ball,
    "car": car,
    "star": star,
}


def wavefront(mesh: Mesh, lift: float) -> str:
    """Return a mesh, raised by `lift` metres, as the text of a Wavefront OBJ file."""
    corners = [f"v {x!r} {y!r} {z!r}" for x, y, z in (mesh.vertices + np.array([0.0, 0.0, lift])).tolist()]
    normals = [f"vn {x!r} {y!r} {z!r}" for x, y, z in mesh.normals.tolist()]
    faces = [f"f {i}/1/{i} {i + 1}/1/{i + 1} {i + 2}/1/{i + 2}" for i in range(1, len(corners) + 1, 3)]
    return "\n".join([*corners, "vt 0 0", *normals, *faces, ""])


def build(shape: str, size: float, height: float, style: int) -> Shape:
    """Return the shape of that name.

    Args:
        shape: Key of `BUILDERS`.
        size: Largest horizontal size without a handle, metres.
        height: Metres; not used by the ball.
        style: Number of a variant.
    """
    return BUILDERS[shape](size, height, style)
