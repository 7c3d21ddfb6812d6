"""Whether spheres touch balls about many points, and how far they are: a grid of distances, and cells of points.

| symbol | meaning | unit |
|---|---|---|
| x | centre of a sphere in the cloud's frame, moved to the nearest point of the grid | [m] |
| h, H | edges of the grid's cells of distances, and of the cells in which points are kept | [m] |
| m, f | middle of the cell of x, and how far the nearest point is from it, at most T | [m] |
| rho | radius of the balls | [m] |

No point is nearer to x than f - |x - m|, and f < T says that one is as near as f + |x - m|. The grid contains all
points and is convex, so that a centre outside is farther from each than x. Only where that leaves open whether a sphere
touches, the points of the cells that it reaches are looked at, in lanes. Source: distances are 1-Lipschitz; the cells
are those of Bentley, Stanat and Williams, The complexity of finding fixed-radius near neighbors (1977).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import (
    Array1,
    Array2,
    any_of,
    broadcast,
    f32,
    first_of,
    lane_numbers,
    least_of,
    procedure,
)
from ulna.typing import Floats

INT = np.int64
_FIELD, _CELL = 0.025, 0.08  # [m] h and H, at least
_MOST_FIELD, _MOST_CELLS = (
    1_500_000,
    400_000,
)  # how many cells a grid has at most: beyond that they are larger
FAR = 0.15
"""Distances in the grid stop at this [m]."""

_LANES = 16
_NOWHERE = 1e15


class Clouds(NamedTuple):
    """Point sets, one after the other.

    Attributes:
        poses: T_world_cloud: R by rows, t, (n, 12) [1], [m].
        numbers: Origin of the grid, 1 / h, h, 1 / H, rho, T, (n, 8) [m], [1/m].
        counts: Cells of the field along x, y, z, where they begin; cells of points likewise, (n, 8).
        field: f of all cells, (cells,) [m].
        starts: Where the points of a cell begin, one more than there are cells, (cells,).
        points: Coordinates, cell after cell, filled up to whole registers, (3, points) [m].
    """

    poses: Array2[f32]
    numbers: Array2[f32]
    counts: Array2[INT]
    field: Array1[f32]
    starts: Array1[INT]
    points: Array2[f32]


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


@procedure(contract=True)
def maybe_near(clouds, k, x, y, z, r, W):
    """The lanes in which spheres may touch cloud k.

    Args:
        clouds: The clouds.
        k: Which.
        x: Centres in the cloud's frame, lanes [m].
        y: Likewise [m].
        z: Likewise [m].
        r: Their radius [m].
        W: Lanes, a constant.

    Returns:
        A mask.
    """
    inverse, h = clouds.numbers[k, 3], clouds.numbers[k, 4]
    u = np.minimum(np.maximum((x - clouds.numbers[k, 0]) * inverse, 0), f32(clouds.counts[k, 0]) - 0.01)
    v = np.minimum(np.maximum((y - clouds.numbers[k, 1]) * inverse, 0), f32(clouds.counts[k, 1]) - 0.01)
    w = np.minimum(np.maximum((z - clouds.numbers[k, 2]) * inverse, 0), f32(clouds.counts[k, 2]) - 0.01)
    a, b, c = int(u), int(v), int(w)
    u, v, w = u - f32(a) - 0.5, v - f32(b) - 0.5, w - f32(c) - 0.5
    field = clouds.field[clouds.counts[k, 3] + (a * clouds.counts[k, 1] + b) * clouds.counts[k, 2] + c]
    return field - np.sqrt(u * u + v * v + w * w) * h <= r + clouds.numbers[k, 6]


@procedure(contract=True)
def nearest_square(clouds, k, x, y, z, far, enough, W):
    """The square of the distance of a cloud's nearest point, where it is below `far`; stops below `enough`.

    Args:
        clouds: The clouds.
        k: Which.
        x: A point in the cloud's frame [m].
        y: Likewise [m].
        z: Likewise [m].
        far: How far is looked [m].
        enough: A square that is small enough [m^2].
        W: Lanes, a constant.

    Returns:
        The square [m^2]; 1e30 where nothing is that near.
    """
    inverse = clouds.numbers[k, 5]
    x0, y0, z0 = x - clouds.numbers[k, 0], y - clouds.numbers[k, 1], z - clouds.numbers[k, 2]
    best = broadcast(f32(1e30), W)
    low = max(int((z0 - far) * inverse), 0)
    high = min(int((z0 + far) * inverse), clouds.counts[k, 6] - 1)
    if low <= high:
        for i in range(
            max(int((x0 - far) * inverse), 0), min(int((x0 + far) * inverse), clouds.counts[k, 4] - 1) + 1
        ):
            for j in range(
                max(int((y0 - far) * inverse), 0), min(int((y0 + far) * inverse), clouds.counts[k, 5] - 1) + 1
            ):
                cell = clouds.counts[k, 7] + (i * clouds.counts[k, 5] + j) * clouds.counts[k, 6]
                for n in range(clouds.starts[cell + low], clouds.starts[cell + high + 1], W):
                    dx = clouds.points[0, n : n + W] - x
                    dy = clouds.points[1, n : n + W] - y
                    dz = clouds.points[2, n : n + W] - z
                    best = np.minimum(best, dx * dx + dy * dy + dz * dz)
                if any_of(best <= enough):
                    return least_of(best)
    return least_of(best)


@procedure
def lane_touches(clouds, k, x, y, z, r, is_open, W):
    """Whether a sphere touches cloud k in one of some lanes.

    Args:
        clouds: The clouds.
        k: Which.
        x: Centres in the cloud's frame, lanes [m].
        y: Likewise [m].
        z: Likewise [m].
        r: Their radius [m].
        is_open: The lanes, a mask.
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
    reach = r + clouds.numbers[k, 6]
    while any_of(is_open):
        lane = first_of(is_open)
        if nearest_square(clouds, k, x[lane], y[lane], z[lane], reach, reach * reach, W) <= reach * reach:
            return True
        is_open = is_open & (lane_numbers(W) != lane)
    return False


@procedure(contract=True)
def in_cloud(poses, k, c, row, W):
    """Centres of spheres in a cloud's frame.

    Args:
        poses: T_world_cloud, (n, 12) [1], [m].
        k: Which.
        c: Centres in the world, three rows each, (rows, W) [m].
        row: The first row of the sphere.
        W: Lanes, a constant.

    Returns:
        x, y, z, lanes [m].
    """
    x = c[row, 0:W] - poses[k, 9]
    y = c[row + 1, 0:W] - poses[k, 10]
    z = c[row + 2, 0:W] - poses[k, 11]
    return (
        poses[k, 0] * x + poses[k, 3] * y + poses[k, 6] * z,
        poses[k, 1] * x + poses[k, 4] * y + poses[k, 7] * z,
        poses[k, 2] * x + poses[k, 5] * y + poses[k, 8] * z,
    )


@procedure(constants={"W": 16})
def clearances(
    clouds: Clouds, points: Array2[f32], radii: Array1[f32], result: Array1[f32], each: int, W: int
) -> None:
    """Writes, for each group of spheres, the least distance of one from cloud 0, or a lower bound of it beyond T.

    Args:
        clouds: The clouds.
        points: Centres in the cloud's frame, group after group, (groups each, 3) [m].
        radii: Radii in a group, (each,) [m].
        result: Receives the distances, (groups,) [m].
        each: How many spheres a group has.
        W: Lanes, a constant.
    """
    rho, far, inverse, h = (
        clouds.numbers[0, 6],
        clouds.numbers[0, 7],
        clouds.numbers[0, 3],
        clouds.numbers[0, 4],
    )
    for g in range(len(result)):
        best = f32(1e30)
        for s in range(each):
            n = g * each + s
            x, y, z = points[n, 0], points[n, 1], points[n, 2]
            u = min(max((x - clouds.numbers[0, 0]) * inverse, 0.0), f32(clouds.counts[0, 0]) - 0.01)
            v = min(max((y - clouds.numbers[0, 1]) * inverse, 0.0), f32(clouds.counts[0, 1]) - 0.01)
            w = min(max((z - clouds.numbers[0, 2]) * inverse, 0.0), f32(clouds.counts[0, 2]) - 0.01)
            a, b, c = int(u), int(v), int(w)
            f = clouds.field[(a * clouds.counts[0, 1] + b) * clouds.counts[0, 2] + c]
            u, v, w = u - f32(a) - 0.5, v - f32(b) - 0.5, w - f32(c) - 0.5
            off = np.sqrt(u * u + v * v + w * w) * h
            least = radii[s] + rho
            if f - off - least < best:
                # the point that is f from the middle is no farther than this from the centre, moved or not
                dx = x - (clouds.numbers[0, 0] + (f32(a) + 0.5) * h)
                dy = y - (clouds.numbers[0, 1] + (f32(b) + 0.5) * h)
                dz = z - (clouds.numbers[0, 2] + (f32(c) + 0.5) * h)
                look = (f + np.sqrt(dx * dx + dy * dy + dz * dz)) * 1.00001 + 0.00001
                if f >= far:
                    look = far
                look = min(look, max(best + least, 0.0))
                distance = f - off
                if distance < look:
                    square = nearest_square(clouds, 0, x, y, z, look, 0.0, W)
                    distance = max(distance, min(np.sqrt(square), look))
                best = min(best, distance - least)
        result[g] = best


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
