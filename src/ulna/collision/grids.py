"""Grids of point sets, made, put together, and asked for distances; what they mean is in `point_grid`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ulna.collision.point_grid import Clouds, clearances
from ulna.compiler.procedures import Array1, Array2, f32, lane_numbers, procedure
from ulna.typing import Floats

INT = np.int64
_FIELD, _CELL = 0.025, 0.08  # [m] h and H, at least
_MOST_FIELD, _MOST_CELLS = 1_500_000, 400_000  # how many cells there are at most: beyond that they are larger
FAR = 0.15
"""Distances in the grid stop at this [m]."""

_LANES = 16
_NOWHERE = 1e15


@procedure(constants={"W": 16})
def _fill(points: Array2[f32], numbers: Array1[f32], field: Array1[f32], counts: Array1[INT], W: int) -> None:
    """Writes the square of the distance of the nearest point to each cell's middle, where it is below T.

    `numbers` are the origin, h and T; rows of `field` along z have room for one more register.
    """
    h, far = numbers[3], numbers[4]
    reach = int(far / h) + 1
    lanes = (lane_numbers(W, f32) + 0.5) * h
    for n in range(points.shape[1]):
        x, y, z = points[0, n] - numbers[0], points[1, n] - numbers[1], points[2, n] - numbers[2]
        i, j, k = int(x / h), int(y / h), int(z / h)
        first = max(k - reach, 0)
        last = min(k + reach, counts[2] - 1)
        for a in range(max(i - reach, 0), min(i + reach, counts[0] - 1) + 1):
            dx = (f32(a) + 0.5) * h - x
            for b in range(max(j - reach, 0), min(j + reach, counts[1] - 1) + 1):
                dy = (f32(b) + 0.5) * h - y
                square = dx * dx + dy * dy
                if square < far * far:
                    row = (a * counts[1] + b) * counts[2]
                    for s in range(first, last + 1, W):
                        dz = lanes + (f32(s) * h - z)
                        old = field[row + s : row + s + W]
                        # lanes beyond the row are cells of the next one: they keep what they have
                        new = np.where(lane_numbers(W) + s <= last, square + dz * dz, old)
                        field[row + s : row + s + W] = np.minimum(old, new)


def grid_of(points: Floats, rho: float, far: float = FAR) -> Clouds:
    """The grid of one point set, whose frame is that of the world.

    Args:
        points: At least one point, shape (n, 3) [m].
        rho: Radius of the balls [m].
        far: Distances in the grid stop at this [m].

    Returns:
        A single cloud.
    """
    low, high = points.min(axis=0) - far, points.max(axis=0) + far
    volume = float(np.prod(high - low))
    h = max(_FIELD, (volume / _MOST_FIELD) ** (1.0 / 3.0))
    H = max(_CELL, (volume / _MOST_CELLS) ** (1.0 / 3.0))
    fine, coarse = (np.maximum(np.ceil((high - low) / edge), 1).astype(np.int64) for edge in (h, H))
    numbers = np.array([*low, 1.0 / h, h, 1.0 / H, rho, far], np.float32)
    field = np.full(int(np.prod(fine)) + _LANES, far * far, np.float32)
    placed = np.ascontiguousarray(points.T, np.float32)
    _fill(placed, np.array([*low, h, far], np.float32), field, fine)
    np.sqrt(field, out=field)
    cells = np.minimum(((placed - numbers[:3, None]) * numbers[5]).astype(np.int64), coarse[:, None] - 1)
    flat = (cells[0] * coarse[1] + cells[1]) * coarse[2] + cells[2]
    starts = np.concatenate([[0], np.cumsum(np.bincount(flat, minlength=int(np.prod(coarse))))])
    filled = np.full((3, len(points) + _LANES), _NOWHERE, np.float32)
    filled[:, : len(points)] = placed[:, np.argsort(flat, kind="stable")]
    counts = np.array([[*fine, 0, *coarse, 0]], np.int64)
    pose = np.array([[1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]], np.float32)
    return Clouds(pose, numbers[None], counts, field, starts, filled)


def joined(clouds: Sequence[tuple[Clouds, Floats]]) -> Clouds:
    """Several point sets at their poses.

    Args:
        clouds: Single clouds, each with T_world_cloud, shape (4, 4) [m].

    Returns:
        All of them; none where there are none.
    """
    if not clouds:
        empty = np.zeros((0, 12), np.float32), np.zeros((0, 8), np.float32), np.zeros((0, 8), np.int64)
        return Clouds(
            *empty, np.zeros(1, np.float32), np.zeros(1, np.int64), np.zeros((3, _LANES), np.float32)
        )
    grids = [cloud for cloud, _ in clouds]
    poses = np.stack([np.append(T[:3, :3].ravel(), T[:3, 3]) for _, T in clouds]).astype(np.float32)
    counts = np.concatenate([g.counts for g in grids])
    counts[:, 3] = np.cumsum([0, *(len(g.field) for g in grids[:-1])])
    counts[:, 7] = np.cumsum([0, *(len(g.starts) for g in grids[:-1])])
    before = np.cumsum([0, *(g.points.shape[1] for g in grids[:-1])])
    return Clouds(
        poses,
        np.concatenate([g.numbers for g in grids]),
        counts,
        np.concatenate([g.field for g in grids]),
        np.concatenate([g.starts + n for g, n in zip(grids, before, strict=True)]),
        np.concatenate([g.points for g in grids], axis=1),
    )


def least_distances(cloud: Clouds, centres: Floats, radii: Floats) -> Floats:
    """How far spheres are from a single point set, the least of each group: exact up to about T, else a lower bound.

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
