"""Clouds and surfaces as points with one radius, that hold what they stand for.

| symbol | meaning | unit |
|---|---|---|
| rho | radius of the balls about the points | [m] |
| c | longest edge of a triangle | [m] |

No point of a triangle is farther than c / sqrt(3) from a corner, so triangles are halved at their longest edges until
their corners, with balls of rho, cover them. Clouds of very many points are merged by cells; the balls grow by as much
as any point is moved.
"""

from __future__ import annotations

import numpy as np

from ulna.geometry import PointCloud
from ulna.typing import Array, Floats

MOST_POINTS = 100_000
"""Clouds of more points are merged."""

_SMALLEST_CELL = (
    0.004  # [m] edges of cells that points are merged in, at first; larger until there are few enough
)
_FINEST, _MOST_SAMPLES = 0.004, 40_000  # [m] rho of surfaces, and about how many points they may take


def thinned(cloud: PointCloud) -> tuple[Floats, float]:
    """The points of a cloud, merged where there are very many, and the radius of the balls that cover its balls.

    Args:
        cloud: The cloud.

    Returns:
        Points, shape (n, 3) [m], and the radius [m].
    """
    points, cell = cloud.points, _SMALLEST_CELL
    if len(points) <= MOST_POINTS:
        return points, cloud.radius
    while True:
        keys = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
        spans = keys.max(axis=0) + 1
        flat = (keys[:, 0] * spans[1] + keys[:, 1]) * spans[2] + keys[:, 2]
        order = np.argsort(flat, kind="stable")
        first = np.flatnonzero(np.diff(flat[order], prepend=-1))
        if len(first) <= MOST_POINTS:
            break
        cell *= max(1.05, float(np.sqrt(len(first) / MOST_POINTS)))
    low, high = (by.reduceat(points[order], first, axis=0) for by in (np.minimum, np.maximum))
    middles = (low + high) / 2.0
    owner = np.repeat(np.arange(len(first)), np.diff(first, append=len(points)))
    moved = np.linalg.norm(points[order] - middles[owner], axis=1).max()
    return middles, cloud.radius + float(moved)


def surface_points(vertices: Floats, triangles: Array) -> tuple[Floats, float]:
    """Points whose balls cover a surface of triangles.

    Args:
        vertices: Corners, shape (n, 3) [m].
        triangles: Their indices, shape (m, 3).

    Returns:
        Points, shape (k, 3) [m], and the radius rho of the balls [m].
    """
    corners = vertices[triangles]
    area = (
        np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        / 2.0
    )
    rho = max(_FINEST, float(np.sqrt(area / (2.0 * _MOST_SAMPLES))))
    done: list[Floats] = []
    while len(corners):
        edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
        longest = edges.argmax(axis=1)
        small = edges.max(axis=1) <= np.sqrt(3.0) * rho
        done.append(corners[small].reshape(-1, 3))
        corners, longest = corners[~small], longest[~small]
        row = np.arange(len(corners))
        a, b, c = (corners[row, (longest + k) % 3] for k in range(3))
        middle = (a + b) / 2.0
        corners = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return _without_repetitions(np.concatenate(done)), rho


def _without_repetitions(points: Floats) -> Floats:
    """The different points among some, by hashes of their coordinates; much faster than np.unique of rows."""
    bits = (np.ascontiguousarray(points) + 0.0).view(np.uint64)  # + 0.0: -0.0 is 0.0
    factors = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    _, first, which = np.unique((bits * factors).sum(axis=1), return_index=True, return_inverse=True)
    different = points[first]
    is_sure = np.array_equal(different[which], points)  # no two different points had one hash
    return different if is_sure else np.unique(points, axis=0)
