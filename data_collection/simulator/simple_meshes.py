"""Simpler meshes of the robot, made when it is loaded: vertices that share a small cube become one.

The models of `icub-models` have up to 20,000 triangles a part, most of them of screws and edges smaller than a pixel.
Sums run in the order of the file, so that every processor makes the same.
"""

from functools import lru_cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from data_collection.log.messages import Floats

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEAD, _COUNT = 80, 4  # bytes of a binary STL file before its triangles: text, and their number


def with_simple_meshes(urdf: str, folder: Path, cell: float) -> str:
    """Write simpler copies of the meshes of a URDF, which has absolute paths; return the URDF that names them.

    Args:
        urdf: Its text.
        folder: Where the copies go.
        cell: Side of the cubes, metres.
    """
    robot = ElementTree.fromstring(urdf)
    for mesh in robot.iter("mesh"):
        path = Path(mesh.get("filename", ""))
        scale = float(mesh.get("scale", "1 1 1").split()[0])
        copy = folder / path.name
        copy.write_bytes(_simpler(path, cell / abs(scale)))
        mesh.set("filename", str(copy))
    return ElementTree.tostring(robot, encoding="unicode")


def simplify(triangles: Floats, cell: float) -> Floats:
    """Merge the corners of triangles (T, 3, 3) that lie in one cube; return what is left of them, each once."""
    corners = triangles.reshape(-1, 3)
    cube = np.floor((corners - corners.min(axis=0)) / cell).astype(np.int64)
    sides = cube.max(axis=0) + 1
    _, own = np.unique((cube[:, 0] * sides[1] + cube[:, 1]) * sides[2] + cube[:, 2], return_inverse=True)
    # `bincount` adds one after the other.
    middles = np.column_stack([np.bincount(own, weights=axis) for axis in corners.T]) / np.bincount(own)[:, None]
    faces = own.reshape(-1, 3)
    flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    faces = faces[~flat]
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    return np.asarray(middles[faces[np.sort(first)]], dtype=np.float64)


@lru_cache(maxsize=128)
def _simpler(path: Path, cell: float) -> bytes:
    """The bytes of a simpler copy of a binary STL file."""
    raw = path.read_bytes()
    count = int.from_bytes(raw[_HEAD : _HEAD + _COUNT], "little")
    read = np.frombuffer(raw, _TRIANGLE, count, _HEAD + _COUNT)["corners"].astype(np.float64)
    left = simplify(read, cell)
    made = np.zeros(len(left), _TRIANGLE)
    made["corners"] = left
    across = np.cross(left[:, 1] - left[:, 0], left[:, 2] - left[:, 0])
    made["normal"] = across / np.maximum(np.sqrt((across**2).sum(axis=1)), 1e-12)[:, None]
    return bytes(_HEAD) + len(made).to_bytes(_COUNT, "little") + made.tobytes()
