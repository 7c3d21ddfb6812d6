"""Coverage and visibility of triangles, against sampling one by one."""

from collections.abc import Callable

import numpy as np
import pytest

from ulna.viewer.render.triangle_filling import fill_triangles
from ulna.viewer.render.zbuffer import clip_near, rasterise


def one_by_one(points: np.ndarray, nearness: np.ndarray, width: int, height: int) -> np.ndarray:
    """The owner of each sample by solving for barycentric coordinates, -1 for nothing."""
    best, owner = np.zeros((height, width)), np.full((height, width), -1)
    for t, (p, near) in enumerate(zip(points, nearness, strict=True)):
        m = np.vstack([p.T, np.ones(3)])
        if abs(np.linalg.det(m)) < 1e-9:
            continue
        y, x = np.mgrid[0:height, 0:width] + 0.5
        w = np.linalg.solve(m, np.stack([x.ravel(), y.ravel(), np.ones(x.size)]))
        value = np.where((w >= -1e-12).all(axis=0), near @ w, -1).reshape(height, width)
        owner = np.where(value > best, t, owner)
        best = np.maximum(best, value)
    return owner


@pytest.mark.parametrize("size", [3.0, 12.0, 60.0, 500.0])
def test_the_nearest_triangle_is_seen(size: float) -> None:
    rng = np.random.default_rng(int(size))
    points = rng.uniform(0, (80, 60), (40, 1, 2)) + rng.uniform(-size, size, (40, 3, 2))
    nearness = rng.uniform(0.5, 2.0, (40, 3))
    near, owner = rasterise(points, nearness, np.arange(40), 80, 60)
    expected = one_by_one(points, nearness, 80, 60)
    found = np.where(near > 0, owner, -1)
    # single precision may decide a sample on an edge, or two surfaces that cross there, the other way
    assert (found != expected).mean() < 0.004


def test_triangles_with_a_common_edge_leave_no_gap() -> None:
    corners = np.array([(3.3, 2.1), (90.7, 5.9), (88.2, 70.4), (5.5, 66.6)])
    points = np.array([corners[[0, 1, 2]], corners[[0, 2, 3]]])
    near, _ = rasterise(points, np.ones((2, 3)), np.zeros(2, dtype=int), 100, 80)
    assert (near[20:60, 20:80] > 0).all()
    assert near[:2].max() == 0


def test_owners_are_found_again_and_absent_ones_are_not() -> None:
    points = np.array([[(0, 0), (40, 0), (0, 40)], [(0, 0), (20, 0), (0, 20)]], dtype=float)
    near, owner = rasterise(points, np.array([[1.0] * 3, [2.0] * 3]), np.array([7, 4_000_000_000]), 40, 40)
    assert owner[2, 2] == 4_000_000_000
    assert owner[12, 12] == 7
    assert near[39, 39] == 0


def filled(
    run: Callable[..., int], points: np.ndarray, nearness: np.ndarray
) -> tuple[int, np.ndarray, np.ndarray]:
    depth, seen = np.zeros(30 * 20, np.float32), np.zeros(30 * 20, np.int64)
    return run(points, nearness, np.arange(len(points)), depth, seen, 30, 20), depth, seen


def test_machine_code_fills_what_the_interpreter_fills() -> None:
    rng = np.random.default_rng(3)
    points = rng.uniform((-5, -5), (35, 25), (12, 3, 2))
    points[0, 1, 1] = points[0, 0, 1]  # a level edge
    points[1] = points[2]  # equally near: the larger number is seen
    nearness = rng.uniform(0.5, 2.0, (12, 3))
    nearness[1:3] = 3.0
    count, depth, seen = filled(fill_triangles, points, nearness)
    assert count == 12 and not (seen == 1).any() and (seen == 2).any()
    for run in (fill_triangles.checked, fill_triangles.interpret):
        other_count, other_depth, other_seen = filled(run, points, nearness)
        assert other_count == count
        assert (other_depth == depth).all() and (other_seen == seen).all()


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e300, -1e300, 1e-300])
def test_corners_that_are_no_numbers_write_nothing_elsewhere(value: float) -> None:
    rng = np.random.default_rng(4)
    for k in range(9):
        points, nearness = rng.uniform(0, 20, (4, 3, 2)), rng.uniform(0.5, 2.0, (4, 3))
        (points if k < 6 else nearness)[1].reshape(-1)[k % 6] = value
        _, depth, _ = filled(fill_triangles.checked, points, nearness)  # raises OutOfBounds where it would
        assert not np.isnan(depth).any()


def test_nothing_to_draw() -> None:
    near, _ = rasterise(np.zeros((0, 3, 2)), np.zeros((0, 3)), np.zeros(0, dtype=int), 4, 3)
    assert near.shape == (3, 4)
    assert (near == 0).all()


def test_triangles_beyond_the_edge_do_not_come_in_again() -> None:
    points = np.array([[(-30, -30), (-20, -30), (-30, -20)], [(50, 50), (70, 50), (50, 70)]], dtype=float)
    near, _ = rasterise(points, np.ones((2, 3)), np.zeros(2, dtype=int), 40, 40)
    assert (near == 0).all()


def area(triangles: np.ndarray) -> float:
    a, b, c = triangles.transpose(1, 0, 2)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.mark.parametrize(
    ("depths", "share"),
    [((2, 2, 2), 1.0), ((0, 0, 0), 0.0), ((2, 2, 0), 0.75), ((2, 0, 0), 0.25), ((0, 2, 0), 0.25)],
)
def test_clipping_leaves_what_lies_beyond_the_plane(depths: tuple[float, ...], share: float) -> None:
    triangle = np.array([[(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]])
    triangle[0, :, 2] = depths
    pieces, owner = clip_near(triangle, 1.0)
    assert (pieces[:, :, 2] >= 1.0 - 1e-12).all()
    assert (owner == 0).all()
    assert (area(pieces) if len(pieces) else 0.0) == pytest.approx(share * area(triangle))
