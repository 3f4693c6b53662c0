import numpy as np
import pytest

from data_collection.simulator.simple_meshes import simplify


def _ball(rings: int) -> np.ndarray:
    """Triangles of a ball of radius 1."""
    polar, around = np.linspace(0, np.pi, rings), np.linspace(0, 2 * np.pi, 2 * rings)
    p, a = np.meshgrid(polar, around, indexing="ij")
    points = np.stack([np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)], axis=2)
    first = np.stack([points[:-1, :-1], points[1:, :-1], points[1:, 1:]], axis=2).reshape(-1, 3, 3)
    second = np.stack([points[:-1, :-1], points[1:, 1:], points[:-1, 1:]], axis=2).reshape(-1, 3, 3)
    return np.concatenate([first, second])


def test_a_simpler_ball_is_still_a_ball() -> None:
    whole = _ball(60)
    simple = simplify(whole, 0.15)
    assert len(simple) < 0.2 * len(whole)
    radius = np.linalg.norm(simple, axis=2)
    assert radius == pytest.approx(1.0, abs=0.15 * 0.15)
    across = np.cross(simple[:, 1] - simple[:, 0], simple[:, 2] - simple[:, 0])
    assert (np.einsum("ij,ij->i", across, simple.mean(axis=1)) > 0).all(), "every triangle still faces outwards"
    area = np.linalg.norm(across, axis=1).sum() / 2
    assert area == pytest.approx(4 * np.pi, rel=0.05), "no holes"


def test_nothing_is_lost_in_small_cubes() -> None:
    ball = _ball(8)
    flat = np.linalg.norm(np.cross(ball[:, 1] - ball[:, 0], ball[:, 2] - ball[:, 0]), axis=1) < 1e-9
    assert len(simplify(ball, 1e-4)) == (~flat).sum()
