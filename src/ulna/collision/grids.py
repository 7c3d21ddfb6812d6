"""Grids of point sets, made, put together, and asked for distances; what they mean is in `point_grid`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ulna.collision.point_grid import Clouds, clearances
from ulna.compiler.procedures import Array1, Array2, f32, lane_numbers, procedure
from ulna.typing import Array, Floats

INT = np.int64
FAR = 0.15
"""Distances are exact up to this [m]."""

_LANES = 16
_NOWHERE = 1e15
_ROUNDING = 3e-6  # of A and B in float32, in T^2
_FINE, _COARSE = (0.025, 0.1, 1_000_000), (0.05, 0.3, 250_000)  # [m] h and T - rho, at least; cells, at most
_LEAST_EDGES, _MOST_EDGES = 4.0, 6.0  # T is between so many edges
_CELL, _MOST_CELLS = 0.08, 400_000  # [m] H, at least; cells of points, at most


class _Grid(NamedTuple):
    """Where the cells of a grid are: the least corner, their number along x, y, z, their edge h, and T [m]."""

    origin: Array
    counts: Array
    edge: float
    far: float

    def numbers(self) -> list[float]:
        """A row of `Clouds.grids`."""
        asked = np.sqrt(self.far**2 - 1.5 * self.edge**2)  # beyond that every cell leaves it open
        return [*self.origin, 1.0 / self.edge, self.edge**2, *self.counts, asked]


def _grid_about(placed: Array, edge: float, far: float, most: int) -> _Grid:
    """A grid about points, (3, n), with at most about `most` cells, whose edges and T are at least as given [m]."""
    low = placed.min(axis=1).astype(float)
    extent = placed.max(axis=1) - low
    edge = max(edge, far / _MOST_EDGES)
    while np.prod((extent + 2.0 * max(far, _LEAST_EDGES * edge)) / edge) > most:
        edge *= 1.1
    far = max(far, _LEAST_EDGES * edge)
    counts = np.maximum(np.ceil((extent + 2.0 * far) / edge), 1.0).astype(np.int64)
    return _Grid((low - far).astype(np.float32), counts, edge, far)


@procedure(constants={"W": 16})
def _fill(
    low: Array2[f32], high: Array2[f32], numbers: Array1[f32], field: Array1[f32], counts: Array1[INT], W: int
) -> None:
    """Writes the square of the distance of the nearest box from each corner of cells, where it is below T.

    `numbers` are the origin, h and T, `counts` the corners along x, y, z; `field` has room for one more register.
    """
    h, far = numbers[3], numbers[4]
    lanes = lane_numbers(W, f32) * h
    for n in range(low.shape[1]):
        x, to_x = low[0, n] - numbers[0], high[0, n] - numbers[0]
        y, to_y = low[1, n] - numbers[1], high[1, n] - numbers[1]
        z, to_z = low[2, n] - numbers[2], high[2, n] - numbers[2]
        first, last = max(int((z - far) / h), 0), min(int((to_z + far) / h), counts[2] - 1)
        for a in range(max(int((x - far) / h), 0), min(int((to_x + far) / h), counts[0] - 1) + 1):
            dx = max(x - f32(a) * h, f32(a) * h - to_x, 0.0)
            for b in range(max(int((y - far) / h), 0), min(int((to_y + far) / h), counts[1] - 1) + 1):
                dy = max(y - f32(b) * h, f32(b) * h - to_y, 0.0)
                square = dx * dx + dy * dy
                if square < far * far:
                    row = (a * counts[1] + b) * counts[2]
                    for s in range(first, last + 1, W):
                        at = lanes + f32(s) * h
                        dz = np.maximum(np.maximum(z - at, at - to_z), 0)
                        old = field[row + s : row + s + W]
                        # lanes beyond the row are corners of the next one: they keep what they have
                        new = np.where(lane_numbers(W) + s <= last, square + dz * dz, old)
                        field[row + s : row + s + W] = np.minimum(old, new)


@procedure(constants={"W": 16})
def _fit(field: Array1[f32], counts: Array1[INT], scale: f32, less: f32, bounds: Array1[f32], W: int) -> None:
    """Writes A and B of all cells, four numbers a cell, from the squares of distances at their corners.

    `counts` are the cells along x, y, z, `scale` is 1 / h^2, and A is smaller by `less`. `field` has room for two more
    registers, `bounds` for one more of cells: what is written beyond a row is the next row's, and written again.
    """
    aside, along = counts[2] + 1, (counts[1] + 1) * (counts[2] + 1)
    for a in range(counts[0]):
        for b in range(counts[1]):
            for c in range(0, counts[2], W):
                n = a * along + b * aside + c
                p000, p001 = _corner(field, n, scale, W), _corner(field, n + 1, scale, W)
                p010, p011 = _corner(field, n + aside, scale, W), _corner(field, n + aside + 1, scale, W)
                n += along
                p100, p101 = _corner(field, n, scale, W), _corner(field, n + 1, scale, W)
                p110, p111 = _corner(field, n + aside, scale, W), _corner(field, n + aside + 1, scale, W)
                # half of what a linear function of least squares grows by along each axis
                u = ((p100 + p101 + p110 + p111) - (p000 + p001 + p010 + p011)) * 0.125
                v = ((p010 + p011 + p110 + p111) - (p000 + p001 + p100 + p101)) * 0.125
                w = ((p001 + p011 + p101 + p111) - (p000 + p010 + p100 + p110)) * 0.125
                p = np.minimum(np.minimum(p000 + w, p001 - w) + v, np.minimum(p010 + w, p011 - w) - v) + u
                q = np.minimum(np.minimum(p100 + w, p101 - w) + v, np.minimum(p110 + w, p111 - w) - v) - u
                cell = ((a * counts[1] + b) * counts[2] + c + lane_numbers(W)) * 4
                bounds[cell] = np.minimum(p, q) - less
                bounds[cell + 1] = u * 2.0
                bounds[cell + 2] = v * 2.0
                bounds[cell + 3] = w * 2.0


@procedure
def _corner(field, n, scale, W):
    """d^2 - |x|^2 at some corners, in lanes, where x is from the middle of their cell, in edges [1]."""
    return field[n : n + W] * scale - 0.75


def grid_of(points: Floats, rho: float) -> Clouds:
    """The grids of one point set, whose frame is that of the world.

    Args:
        points: At least one point, shape (n, 3) [m].
        rho: Radius of the balls [m].

    Returns:
        A single cloud.
    """
    placed = np.ascontiguousarray(points.T, np.float32)
    fine, coarse = (_grid_about(placed, edge, far + rho, most) for edge, far, most in (_FINE, _COARSE))
    bounds = [_bounds(placed, placed, fine), _bounds(*_boxes(placed, coarse), coarse)]
    cell = max(_CELL, fine.edge * (float(np.prod(fine.counts)) / _MOST_CELLS) ** (1.0 / 3.0))
    counts = np.ceil(fine.counts * (fine.edge / cell)).astype(np.int64)
    order, starts = _by_cells(placed, fine.origin, cell, counts)
    filled = np.full((3, len(points) + _LANES), _NOWHERE, np.float32)
    filled[:, : len(points)] = placed[:, order]
    return Clouds(
        np.array([[1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]], np.float32),
        np.array([[grid.numbers() for grid in (fine, coarse)]], np.float32),
        np.array([[0, len(bounds[0])]], np.int64),
        np.concatenate(bounds),
        np.array([[1.0 / cell, rho, FAR + rho]], np.float32),
        np.array([[*counts, 0]], np.int64),
        starts,
        filled,
    )


def _bounds(low: Array, high: Array, grid: _Grid) -> Array:
    """A, B of all cells of a grid, from boxes that hold the points, (3, n) each [m]; shape (4 cells,)."""
    corners = grid.counts + 1
    field = np.full(int(np.prod(corners)) + 2 * _LANES, grid.far**2, np.float32)
    _fill(low, high, np.array([*grid.origin, grid.edge, grid.far], np.float32), field, corners)
    bounds = np.empty(4 * (int(np.prod(grid.counts)) + _LANES), np.float32)
    scale = grid.edge**-2
    _fit(field, grid.counts, scale, _ROUNDING * grid.far**2 * scale, bounds)
    return bounds


def _boxes(placed: Array, grid: _Grid) -> tuple[Array, Array]:
    """Boxes about the points in each of the cells of a grid, by their corners, (3, n) each [m]."""
    order, starts = _by_cells(placed, grid.origin, grid.edge, grid.counts)
    first, sorted_ = np.unique(starts[:-1][np.diff(starts) > 0]), placed[:, order]
    return np.minimum.reduceat(sorted_, first, axis=1), np.maximum.reduceat(sorted_, first, axis=1)


def _by_cells(placed: Array, origin: Array, edge: float, counts: Array) -> tuple[Array, Array]:
    """The order of points by cells, and where those of each cell begin, one more than there are cells."""
    cells = ((placed - origin[:, None]) * np.float32(1.0 / edge)).astype(np.int64)
    cells = np.minimum(np.maximum(cells, 0), counts[:, None] - 1)
    flat = (cells[0] * counts[1] + cells[1]) * counts[2] + cells[2]
    starts = np.zeros(int(np.prod(counts)) + 1, np.int64)
    np.cumsum(np.bincount(flat, minlength=len(starts) - 1), out=starts[1:])
    return np.argsort(flat, kind="stable"), starts


def joined(clouds: Sequence[tuple[Clouds, Floats]]) -> Clouds:
    """Several point sets at their poses.

    Args:
        clouds: Single clouds, each with T_world_cloud, shape (4, 4) [m].

    Returns:
        All of them; none where there are none.
    """
    if not clouds:
        return Clouds(
            np.zeros((0, 12), np.float32), np.zeros((0, 2, 9), np.float32), np.zeros((0, 2), np.int64),
            np.zeros(4, np.float32), np.zeros((0, 3), np.float32), np.zeros((0, 4), np.int64),
            np.zeros(1, np.int64), np.zeros((3, _LANES), np.float32),
        )  # fmt: skip
    grids = [cloud for cloud, _ in clouds]
    poses = np.stack([np.append(T[:3, :3].ravel(), T[:3, 3]) for _, T in clouds]).astype(np.float32)
    if len(grids) == 1:  # nothing is copied
        return grids[0]._replace(poses=poses)
    begins = np.concatenate([g.begins for g in grids])
    begins += np.cumsum([0, *(len(g.bounds) for g in grids[:-1])])[:, None]
    counts = np.concatenate([g.counts for g in grids])
    counts[:, 3] = np.cumsum([0, *(len(g.starts) for g in grids[:-1])])
    before = np.cumsum([0, *(g.points.shape[1] for g in grids[:-1])])
    return Clouds(
        poses,
        np.concatenate([g.grids for g in grids]),
        begins,
        np.concatenate([g.bounds for g in grids]),
        np.concatenate([g.numbers for g in grids]),
        counts,
        np.concatenate([g.starts + n for g, n in zip(grids, before, strict=True)]),
        np.concatenate([g.points for g in grids], axis=1),
    )


def least_distances(cloud: Clouds, centres: Floats, radii: Floats) -> Floats:
    """How far spheres are from a point set, the least of each group: exact up to `FAR`, else a lower bound.

    Args:
        cloud: The point set, as `grid_of` returns it.
        centres: Centres in its frame, shape (..., spheres, 3) [m].
        radii: Radii, shape (spheres,) [m].

    Returns:
        Distances, shape (...) [m], too small by up to some micrometres: positions are rounded to float32.
    """
    batch = centres.shape[:-2]
    flat = np.ascontiguousarray(centres.reshape(-1, 3), np.float32)
    result = np.empty(int(np.prod(batch)), np.float32)
    clearances(cloud, flat, radii.astype(np.float32), result, len(radii))
    slack = 3e-6 + 3e-7 * float(np.abs(flat).max(initial=0.0))
    return result.reshape(batch).astype(float) - slack
