"""Convex solids that together contain a mesh: its surface is cut where that makes the hulls of the parts smaller.

Each part of the surface lies in its hull, so a distance of the hulls is never more than that of the surfaces; and
convex solids are compared hundreds of times as fast as thousands of triangles. Source: Lien and Amato, Approximate
convex decomposition of polyhedra, Computer Aided Geometric Design 25 (2008), for the greedy cuts; here by planes
across the axes, with the volume of the hulls as measure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import final

import numpy as np

from ulna.collision.solids import Solid, hull, qhull_of
from ulna.errors import InputError
from ulna.geometry import HeightField, Mesh, PointCloud
from ulna.typing import Floats

_MOST = 16  # parts of a mesh
_LEAST_GAIN = 0.002  # of a cut, in the volume of the whole hull
_CUTS = (0.2, 0.4, 0.6, 0.8)  # places of cuts that are tried, in parts of an edge
_GRID = 40  # cells along the longest edge in which one corner stands for all while cuts are compared
_THICKNESS = 5e-5  # that flat parts are given, to either side [m]


def convex_pieces(solids: Sequence[Solid]) -> list[Solid]:
    """Solids that contain the solids of a link, all convex.

    Args:
        solids: The solids.

    Returns:
        The same, with parts in place of meshes: meshes of a few corners, to be taken by their hulls.
    """
    return [piece for solid in solids for piece in _pieces(solid)]


def _pieces(solid: Solid) -> list[Solid]:
    if not isinstance(solid.shape, Mesh | HeightField | PointCloud):
        return [solid]
    parts = [_Part(solid.vertices[solid.triangles])]
    least = _LEAST_GAIN * parts[0].most_gain
    while len(parts) < _MOST:
        best = max(parts, key=lambda part: part.most_gain)
        if best.most_gain <= least:
            break
        if best.cut is None:  # only now that it may be the best
            best.find_cut()
        else:
            parts.remove(best)
            parts += best.halves()
    hulls = [_hull(part.triangles.reshape(-1, 3)) for part in parts]
    return [replace(solid, vertices=vertices, triangles=triangles) for vertices, triangles in hulls]


def _hull(points: Floats) -> tuple[Floats, Floats]:
    try:
        return hull(points)
    except InputError:  # they lie in a plane
        corners = np.array(np.meshgrid(*3 * [[-_THICKNESS, _THICKNESS]])).reshape(3, -1).T
        return hull((points[:, None] + corners).reshape(-1, 3))


def _volume(points: Floats) -> float:
    try:
        return float(qhull_of(points).volume)
    except (InputError, ValueError):
        return 0.0


@final
class _Part:
    """A part of a surface.

    Args:
        triangles: Corners, shape (m, 3, 3) [m].
    """

    def __init__(self, triangles: Floats) -> None:
        self.triangles = triangles
        self.most_gain = _volume(
            triangles.reshape(-1, 3)
        )  # by which a cut makes the hulls smaller at most [m^3]
        self.cut: tuple[int, float] | None = None  # the axis across which the best one is, and where [m]

    def find_cut(self) -> None:
        """Finds the best of some cuts."""
        points = self.triangles.reshape(-1, 3)
        low, high = points.min(axis=0), points.max(axis=0)
        edge = max(float((high - low).max()) / _GRID, 1e-12)
        coarse, best = _snapped(self.triangles, low, edge), (0.0, 0, 0.0)
        whole = _volume(_distinct(coarse, low, edge))
        for axis in range(3):
            for part in _CUTS:
                place = float(low[axis] + part * (high[axis] - low[axis]))
                halves = _cut(coarse, axis, place)
                gain = whole - sum(_volume(_distinct(half, low, edge)) for half in halves if len(half))
                best = max(best, (gain, axis, place))
        self.most_gain, self.cut = best[0], best[1:]

    def halves(self) -> list[_Part]:
        """What the best cut makes of it."""
        assert self.cut is not None
        return [_Part(half) for half in _cut(self.triangles, *self.cut) if len(half)]


def _snapped(triangles: Floats, low: Floats, edge: float) -> Floats:
    """Triangles with corners on a grid, without those that became points or lines."""
    cells = np.round((triangles - low) / edge).astype(int)
    is_thin = np.zeros(len(cells), dtype=bool)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        is_thin |= (cells[:, i] == cells[:, j]).all(axis=1)
    thick_cells = cells[~is_thin] if not is_thin.all() else cells
    return low + edge * np.unique(thick_cells, axis=0)


def _distinct(triangles: Floats, low: Floats, edge: float) -> Floats:
    """The corners of triangles, each once where it lies on the grid, or nearly so."""
    points = triangles.reshape(-1, 3)
    cells = np.round((points - low) * (4.0 / edge)).astype(
        np.int64
    )  # cuts end between the places of the grid
    _, first = np.unique((cells[:, 0] << 40) + (cells[:, 1] << 20) + cells[:, 2], return_index=True)
    return points[first]


def _cut(triangles: Floats, axis: int, place: float) -> tuple[Floats, Floats]:
    """The triangles below and above a plane across an axis; those that cross it are divided."""
    above = triangles[:, :, axis] - place
    is_below, is_above = (above <= 0.0).all(axis=1), (above > 0.0).all(axis=1)
    sides = [[triangles[is_below]], [triangles[is_above]]]
    crossing = ~(is_below | is_above)
    corners, heights = triangles[crossing], above[crossing]
    upper = heights > 0.0
    for side, has_single in enumerate(
        (upper.sum(axis=1) == 2, upper.sum(axis=1) == 1)
    ):  # a corner below, or above
        single_corner_triangles, is_upper = corners[has_single], upper[has_single]
        single = (is_upper if side else ~is_upper).argmax(axis=1)
        order = (single[:, None] + np.arange(3)) % 3
        p = np.take_along_axis(single_corner_triangles, order[:, :, None], axis=1)
        h = np.take_along_axis(heights[has_single], order, axis=1)
        a, b = (p[:, 0] + (h[:, :1] / (h[:, :1] - h[:, k : k + 1])) * (p[:, k] - p[:, 0]) for k in (1, 2))
        sides[side].append(np.stack([p[:, 0], a, b], axis=1))
        sides[1 - side].append(np.stack([a, p[:, 1], p[:, 2]], axis=1))
        sides[1 - side].append(np.stack([a, p[:, 2], b], axis=1))
    return np.concatenate(sides[0]), np.concatenate(sides[1])
