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

INT = np.int64


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
        c: Centres in the world, three rows of W numbers each [m].
        row: The first row of the sphere.
        W: Lanes, a constant.

    Returns:
        x, y, z, lanes [m].
    """
    at = row * W
    x = c[at : at + W] - poses[k, 9]
    y = c[at + W : at + W + W] - poses[k, 10]
    z = c[at + 2 * W : at + 2 * W + W] - poses[k, 11]
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
