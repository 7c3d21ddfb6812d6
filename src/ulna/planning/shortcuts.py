"""Shortens a path of straight motions by shortcuts between random points on it, as a procedure.

Source: Geraerts and Overmars, Creating high-quality paths for motion planning, International Journal of Robotics
Research 26 (2007), section 5.
"""

from __future__ import annotations

import numpy as np

from ulna.compiler.procedures import Array1, Array2, Kernel, f32, procedure
from ulna.planning.edges import edge_touches
from ulna.planning.touching import Tables

INT = np.int64


@procedure
def _between(points, i, part, result):
    """The point a part of the way from point i to the next."""
    for k in range(len(result)):
        result[k] = points[i, k] + part * (points[i + 1, k] - points[i, k])


@procedure
def _length_between(a, b):
    """The distance of two configurations."""
    total = f32(0.0)
    for k in range(len(a)):
        total += (b[k] - a[k]) * (b[k] - a[k])
    return np.sqrt(total)


@procedure
def _copy_row(points, to, source):
    """Copies a point within a path."""
    for k in range(points.shape[1]):
        points[to, k] = points[source, k]


@procedure
def _without_points(kernel, tables, reach, step, points, count, q, c, W):
    """Leaves out each point whose neighbours a straight motion can join; returns how many are left."""
    left = count
    i = 0
    while i < left - 2:
        if edge_touches(kernel, tables, reach, step, points[i], points[i + 2], q, c, W):
            i += 1
        else:
            for k in range(i + 1, left - 1):
                _copy_row(points, k, k + 1)
            left -= 1
    return left


@procedure(constants={"W": 8})
def shorten(
    kernel: Kernel, tables: Tables, reach: Array2[f32], step: f32, points: Array2[f32], count: int,
    draws: Array2[f32], left: Array1[f32], right: Array1[f32], q: Array2[f32], c: Array2[f32], W: int,
) -> int:  # fmt: skip
    """Replaces parts of a path by straight motions, one for each row of `draws` that is free and shorter.

    Points that can be left out are left out before and after.

    Args:
        kernel: From configurations to centres of spheres, in lanes.
        tables: What is checked against what.
        reach: Bounds of motion, shape (L, n) [m/rad], [1].
        step: How far anything moves at most between checked states [m].
        points: The path, with room for a point more for each row of `draws`, shape (room, n) [rad, m].
        count: How many points the path has.
        draws: Where along the path, by segments, a shortcut begins and ends, shape (tries, 2), from 0 to 1.
        left: Working storage, shape (n,).
        right: Working storage, shape (n,).
        q: Working storage, shape (n, W) [rad, m].
        c: Working storage, shape (3 (L + S), W) [m].
        W: Lanes, a constant.

    Returns:
        How many points there are.
    """
    count = _without_points(kernel, tables, reach, step, points, count, q, c, W)
    for d in range(len(draws)):
        if count < 3:
            return count
        low, high = min(draws[d, 0], draws[d, 1]), max(draws[d, 0], draws[d, 1])
        at, until = low * f32(count - 1), high * f32(count - 1)
        i, j = int(at), int(until)
        if j <= i or j > count - 2:
            continue
        _between(points, i, at - f32(i), left)
        _between(points, j, until - f32(j), right)
        before = _length_between(left, points[i + 1]) + _length_between(points[j], right)
        for k in range(i + 1, j):
            before += _length_between(points[k], points[k + 1])
        if _length_between(left, right) > before * 0.999:
            continue
        if edge_touches(kernel, tables, reach, step, left, right, q, c, W):
            continue
        # points i + 1 to j become left and right
        if j == i + 1:
            for k in range(count, j + 1, -1):
                _copy_row(points, k, k - 1)
            count += 1
        else:
            removed = j - i - 2
            for k in range(j + 1, count):
                _copy_row(points, k - removed, k)
            count -= removed
        for k in range(points.shape[1]):
            points[i + 1, k] = left[k]
            points[i + 2, k] = right[k]
    return _without_points(kernel, tables, reach, step, points, count, q, c, W)
