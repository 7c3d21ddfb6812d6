"""The space that a link fills: its surface in small pieces, what is inside on a grid, and signed distances.

| symbol | meaning | shape | unit |
|---|---|---|---|
| h | edge of a cell of the grid | | [m] |
| delta | no point of the surface is farther from a corner of a piece: h / sqrt(3) | | [m] |
| x | corners of the pieces | (n, 3) | [m] |
| s | signed distance from the surface: negative inside | | [m] |

Cells whose centres are within h / 2 + delta of a corner are the wall: a step between neighbouring cells crosses the
surface within h / 2 of one of their centres, hence never outside of the wall. What a flood fill from the corner of
the grid does not reach is inside. That needs no closed mesh and no order of its corners: an open mesh has no inside,
and only its surface is covered. Cavities count as inside, and surfaces in them do not count.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any, final

import numpy as np

from ulna.collision.polyhedra import distance, split
from ulna.data_classes import dataclass
from ulna.errors import needed
from ulna.typing import Array, Floats

_CELLS = 50_000  # of a grid, about
_AXIS = 150  # cells along an axis, at most
_TREE = 10_000  # corners in the search tree
_BORDER = 4
_TABLE = 30  # as many cells for each point are looked up in a table; sorting is faster for more


@final
@dataclass(frozen=True, eq=False)
class Region:
    """The space that solids fill together.

    Attributes:
        pieces: Their surfaces as small triangles, shape (p, 3, 3) [m].
        outer: Those that can be reached from outside, or nearly, shape (m, 3, 3) [m].
        corners: x, shape (n, 3) [m].
        h: Edge of a cell [m].
        origin: Corner of the grid, shape (3,) [m].
        inside: Which cells are inside, shape of the grid.
        wall: Which cells are at the surface, shape of the grid.
        tree: Search tree of some of the corners of outer pieces.
    """

    pieces: Floats
    outer: Floats
    corners: Floats
    h: float
    origin: Floats
    inside: Array
    wall: Array
    tree: Any

    def centres(self, cells: Array) -> Floats:
        """The centres of cells.

        Args:
            cells: Truth values, shape of the grid.

        Returns:
            Points, shape (n, 3) [m].
        """
        return self.origin + (np.argwhere(cells) + 0.5) * self.h

    @property
    def shallow(self) -> Array:
        """Which cells are inside and within two cells of the wall, shape of the grid."""
        from scipy import ndimage

        return self.inside & ~ndimage.binary_erosion(self.inside, iterations=2)

    def signed(self, points: Floats) -> Floats:
        """How far points are from the surface, negative inside; positive within the wall, where the sign is open.

        Args:
            points: Shape (m, 3) [m].

        Returns:
            s, shape (m,) [m]; by few corners, so that the distance may be too large by some hundredths of h.
        """
        return np.where(self._within(points), -1.0, 1.0) * self.tree.query(points)[0]

    def signed_exactly(self, points: Floats) -> Floats:
        """The same with the distance of the surface itself.

        Args:
            points: Shape (m, 3) [m].

        Returns:
            s, shape (m,) [m].
        """
        rough, nearest = self.tree.query(points)[0], np.zeros(len(points))
        for k, (point, reach) in enumerate(zip(points, rough + self.h, strict=True)):
            near = ((self.outer[:, 0] - point) ** 2).sum(axis=1) <= (reach * (1.0 + 1e-9)) ** 2
            nearest[k] = distance(point, self.outer[near])
        return np.where(self._within(points), -1.0, 1.0) * nearest

    def _within(self, points: Floats) -> Array:
        """Which points are in a cell that is inside."""
        cells = np.floor((points - self.origin) / self.h).astype(int)
        known = ((cells >= 0) & (cells < self.inside.shape)).all(axis=1)
        within = np.zeros(len(points), dtype=bool)
        within[known] = self.inside[tuple(cells[known].T)]
        return within


def region(triangles: Floats, buried: Callable[[Floats], Array], finest: float = 0.0) -> Region:
    """The space that surfaces enclose.

    Args:
        triangles: The surfaces, in any order, shape (m, 3, 3) [m].
        buried: From triangles, shape (n, 3, 3) [m], to which are known to be inside, shape (n,).
        finest: The least edge of a cell [m].

    Returns:
        The region.

    Raises:
        MissingExtra: If scipy is not installed.
    """
    with needed("scipy", "collision", "Fitting spheres"):
        from scipy import ndimage
        from scipy.spatial import KDTree
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    h = max(_edge(high - low), finest)
    pieces = split(triangles, h)
    hidden = buried(pieces)
    corners = pieces[~hidden].reshape(-1, 3)
    corners = corners[_one_in_each_cell(corners, low - h, h * 1e-3)]
    origin = low - _BORDER * h
    wall = _wall(corners, origin, h, np.ceil((high - low) / h).astype(int) + 2 * _BORDER)
    labels: Any = ndimage.label(~wall)[0]  # type: ignore[index]
    outside = labels == labels[0, 0, 0]
    near: Any = ndimage.binary_dilation(outside, np.ones((3, 3, 3)), iterations=2)
    outer = (
        near[tuple(np.floor((pieces - origin) / h).astype(int).reshape(-1, 3).T)].reshape(-1, 3).any(axis=1)
    )
    outer &= ~hidden
    is_reached = near[tuple(np.floor((corners - origin) / h).astype(int).T)]
    wall = _wall(corners[is_reached], origin, h, np.array(wall.shape))
    tree = KDTree(thinned(corners[is_reached], _TREE), leafsize=64)
    return Region(pieces, pieces[outer], corners, h, origin, ~outside & ~wall, wall & ~outside, tree)


def _wall(corners: Floats, origin: Floats, h: float, size: Array) -> Array:
    """The cells whose centres are near corners, shape of the grid."""
    wall = np.zeros(size, dtype=bool)
    flat, strides = wall.reshape(-1), (int(size[1] * size[2]), int(size[2]))
    reach = h * (0.5 + 1.0 / np.sqrt(3.0))
    cells = [np.floor((corners[:, k] - origin[k]) / h).astype(int) for k in range(3)]
    here = (cells[0] * strides[0] + cells[1] * strides[1]) + cells[2]
    apart = {
        (k, step): (origin[k] + (cells[k] + step + 0.5) * h - corners[:, k]) ** 2
        for k in range(3)
        for step in (-1, 0, 1)
    }
    for i, j in product((-1, 0, 1), repeat=2):
        across = apart[0, i] + apart[1, j]
        for k in (-1, 0, 1):
            close = across + apart[2, k] <= reach**2
            flat[here[close] + i * strides[0] + j * strides[1] + k] = True
    return wall


def _edge(size: Floats) -> float:
    """The edge of a cell for a box of this size."""
    longest = float(size.max())
    volume = float(np.prod(np.maximum(size, longest / _AXIS)))
    return max((volume / _CELLS) ** (1.0 / 3.0), longest / _AXIS)


def thinned(points: Floats, most: int) -> Floats:
    """At most so many of some points, spread evenly: one for each cell of a grid.

    Args:
        points: Shape (n, 3) [m].
        most: How many.

    Returns:
        Points, shape (m, 3) [m].
    """
    if len(points) <= most:
        return points
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    step = float(size.max()) / most ** (1.0 / 2.0)
    while True:
        chosen = _one_in_each_cell(points, low, step)
        if len(chosen) <= most:
            return points[chosen]
        step *= max(1.05, (len(chosen) / most) ** (1.0 / 3.0))


def _one_in_each_cell(points: Floats, low: Floats, step: float) -> Array:
    """Indices of points, one in each cell of a grid that holds any."""
    cell = np.floor((points - low) / step).astype(np.int64)
    size = cell.max(axis=0) + 1
    keys = (cell[:, 0] * size[1] + cell[:, 1]) * size[2] + cell[:, 2]
    if float(np.prod(size.astype(float))) > _TABLE * len(points):
        return np.unique(keys, return_index=True)[1]
    first = np.full(int(np.prod(size)), -1)
    first[keys[::-1]] = np.arange(len(points))[::-1]  # of equal keys the last one written stays
    return first[first >= 0]
