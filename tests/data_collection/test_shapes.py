import numpy as np
import pytest

from data_collection.shapes import BUILDERS, Mesh, build

CASES = [
    (shape, style)
    for shape, styles in (("box", 1), ("ball", 1), ("cup", 2), ("car", 4), ("star", 2))
    for style in range(styles)
]


def _volume(mesh: Mesh) -> float:
    """Return the volume enclosed by a mesh whose triangles face outwards (divergence theorem)."""
    a, b, c = mesh.vertices.reshape(-1, 3, 3).transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(("shape", "style"), CASES)
def test_size_and_ground(shape: str, style: int) -> None:
    made = build(shape, 0.06, 0.05, style)
    points = np.concatenate([mesh.vertices for mesh in made.meshes])
    assert np.isfinite(points).all()
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert made.height == pytest.approx(0.06 if shape == "ball" else 0.05)
    assert made.extents[0] <= 1.35 * 0.06, "a handle may stick out"
    assert np.hypot(points[:, 0], points[:, 1]).max() == pytest.approx(made.radius)


@pytest.mark.parametrize(("shape", "style"), CASES)
def test_normals_are_unit_vectors_of_their_triangles(shape: str, style: int) -> None:
    for mesh in build(shape, 0.06, 0.05, style).meshes:
        corners = mesh.vertices.reshape(-1, 3, 3)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        agree = np.einsum("ij,ij->i", np.repeat(normals, 3, axis=0), mesh.normals)
        assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0)
        assert (agree > 0).all()


@pytest.mark.parametrize(
    ("shape", "style", "volume"),
    [
        ("box", 0, 0.06**2 * 0.05),
        ("ball", 0, np.pi / 6 * 0.06**3),
        ("star", 0, 0.05 * 10 * 0.5 * 0.03 * 0.0135 * np.sin(np.pi / 5)),
    ],
)
def test_closed_and_outwards(shape: str, style: int, volume: float) -> None:
    assert _volume(build(shape, 0.06, 0.05, style).meshes[0]) == pytest.approx(volume, rel=0.02)


def test_styles_and_sizes_differ() -> None:
    cars = [build("car", 0.06, 0.05, style).meshes[0].vertices for style in range(4)]
    assert len({points.tobytes() for points in cars}) == 4
    assert build("cup", 0.05, 0.05, 1).radius > build("cup", 0.05, 0.05, 0).radius, "a handle sticks out"


def test_every_builder_is_tested() -> None:
    assert {shape for shape, _ in CASES} == set(BUILDERS)
