"""Shortens and rounds a path of straight motions, as a procedure.

Each point is joined to the farthest later one that a straight motion reaches; then corners are cut, and both are
repeated while they change something. Source: Geraerts and Overmars, Creating high-quality paths for motion planning,
International Journal of Robotics Research 26 (2007), section 5, for shortcuts; Pan, Zhang and Manocha, Collision-free
and smooth trajectory computation in cluttered environments, same journal 31 (2012), section 4, for the corners: a
subdivision step of a cubic B-spline where it is free.
"""

from __future__ import annotations

import numpy as np

from ulna.collision.lanes.touching import Tables, Work
from ulna.compiler.procedures import Array2, Kernel, f32, procedure
from ulna.planning.edges import edge_touches
from ulna.planning.rrt_connect import read_path
from ulna.planning.trees import Trees

LEAST_CHANGE = 0.1
"""Corners that would move by less than this stay [rad, m]."""


@procedure
def _copy_row(points, to, source):
    """Copies a point within a path."""
    for k in range(points.shape[1]):
        points[to, k] = points[source, k]


@procedure
def _shortcuts(kernel, tables, step, points, count, work, W):
    """Joins each point to the farthest later one that is in reach; returns how many points are left."""
    i = 0
    while i < count - 2:
        j = count - 1
        while j > i + 1 and edge_touches(kernel, tables, step, points[i], points[j], work, W):
            j -= 1
        removed = j - i - 1
        if removed > 0:
            for k in range(j, count):
                _copy_row(points, k - removed, k)
            count -= removed
        i += 1
    return count


@procedure
def _subdivide(points, count):
    """Puts a point in the middle of each edge."""
    for i in range(count - 1, 0, -1):
        _copy_row(points, 2 * i, i)
        for k in range(points.shape[1]):
            points[2 * i - 1, k] = f32(0.5) * (points[i, k] + points[i - 1, k])
    return 2 * count - 1


@procedure
def _cut_corners(kernel, tables, step, points, count, corner, work, W):
    """Moves every second point to where a cubic B-spline passes, where that is free; whether any was moved."""
    is_changed = False
    for i in range(2, count - 1, 2):
        change = f32(0.0)
        for k in range(len(corner)):
            middle = f32(0.5) * (points[i - 1, k] + points[i + 1, k])
            corner[k] = f32(0.5) * (points[i, k] + middle)
            change += (corner[k] - points[i, k]) * (corner[k] - points[i, k])
        if np.sqrt(change) <= f32(LEAST_CHANGE):
            continue
        if edge_touches(kernel, tables, step, points[i - 1], corner, work, W):
            continue
        if edge_touches(kernel, tables, step, corner, points[i + 1], work, W):
            continue
        for k in range(len(corner)):
            points[i, k] = corner[k]
        is_changed = True
    return is_changed


@procedure
def _shorten(kernel, tables, step, points, count, rounds, corner, work, W):
    """Shortens a path and cuts its corners; returns how many points there are."""
    for _ in range(rounds):
        if count < 3:
            break
        before = count
        count = _shortcuts(kernel, tables, step, points, count, work, W)
        is_changed = count < before
        if count > 2 and 2 * count <= len(points):
            count = _subdivide(points, count)
            if _cut_corners(kernel, tables, step, points, count, corner, work, W):
                is_changed = True
        if not is_changed:
            break
    return count


@procedure(constants={"W": 8})
def shortened_path(
    kernel: Kernel,
    tables: Tables,
    step: f32,
    trees: Trees,
    path: Array2[f32],
    rounds: int,
    work: Work,
    W: int,
) -> int:
    """The path at which trees met, shorter and with corners cut.

    Args:
        kernel: From configurations to poses of the bodies, in lanes.
        tables: What is checked against what.
        step: How far anything moves at most between checked states [m].
        trees: Both trees.
        path: Receives the path, shape (room, n) [rad, m].
        rounds: How often it is shortened at most.
        work: Working storage.
        W: Lanes, a constant.

    Returns:
        How many points the path has; -1 if there is no room for it.
    """
    count = read_path(trees, path)
    if count < 0:
        return -1
    return _shorten(kernel, tables, step, path, count, rounds, trees.new, work, W)
