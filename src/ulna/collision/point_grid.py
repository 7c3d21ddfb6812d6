"""Whether spheres touch balls about many points, and how far they are: two grids of bounds, and cells of points.

| symbol | meaning | unit |
|---|---|---|
| x | centre of a sphere in the cloud's frame, moved to the nearest point of the grid | [m] |
| p, d | points of the cloud, and how far the nearest one is, at most T | [m] |
| h, H | edges of a grid's cells, and of the cells in which points are kept | [m] |
| u | x from the middle of its cell, in edges | [1] |
| A, B | of each cell, see below | [1] |
| rho | radius of the balls | [m] |

d^2 - |x|^2 is the least of |p|^2 - 2 p.x over all points, and T^2 - |x|^2: concave, as each of them is. So a linear
function that is not above it at the corners of a cell is nowhere above it in the cell, and with A and B fitted to the
corners d^2 >= h^2 (|u|^2 + B.u + A). Where one point is the nearest in all of a cell, this is d^2 itself; else it is
less by about h^2 / 2. A grid contains all points and is convex, so that a centre outside is farther from each than x.

The fine grid tells small distances; the coarse one, with larger cells, and boxes around the points of each cell in
place of the points, tells larger ones, for the bounding spheres of links. Only where they leave open whether a sphere
touches, the points of the cells that it reaches are looked at, in lanes. Source: the nearest point as the upper
envelope of linear functions, Aurenhammer, Voronoi diagrams, ACM Computing Surveys 23 (1991), section 3.1; the cells of
points are those of Bentley, Stanat and Williams, The complexity of finding fixed-radius near neighbors (1977).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import (
    Array1,
    Array2,
    Array3,
    any_of,
    broadcast,
    f32,
    first_of,
    lane_numbers,
    least_of,
    procedure,
)

INT = np.int64
FINE, COARSE = 0, 1


class Clouds(NamedTuple):
    """Point sets, one after the other.

    Attributes:
        poses: T_world_cloud: R by rows, t, (n, 12) [1], [m].
        grids: Of the fine and of the coarse grid the origin, 1 / h, h^2, cells along x, y, z, and up to which distance
            it is asked, (n, 2, 8) [m], [1/m], [m^2], [1], [m].
        begins: Where the cells of both begin, (n, 2).
        bounds: A, B of all their cells, (4 cells,) [1].
        numbers: 1 / H, rho, and up to which distance points are looked for, (n, 3) [1/m], [m].
        counts: Cells of points along x, y, z, whose origin is that of the fine grid, and where they begin, (n, 4).
        starts: Where the points of a cell begin, one more than there are cells, (cells,).
        points: Coordinates, cell after cell, filled up to whole registers, (3, points) [m].
    """

    poses: Array2[f32]
    grids: Array3[f32]
    begins: Array2[INT]
    bounds: Array1[f32]
    numbers: Array2[f32]
    counts: Array2[INT]
    starts: Array1[INT]
    points: Array2[f32]


@procedure
def level_for(clouds, k, reach):
    """The grid that tells whether a point is nearer than a distance.

    Args:
        clouds: The clouds.
        k: Which.
        reach: The distance [m].

    Returns:
        `FINE` or `COARSE`.
    """
    if reach < clouds.grids[k, FINE, 8]:
        return FINE
    return COARSE


@procedure(contract=True)
def least_square(clouds, k, level, x, y, z):
    """The square of a distance below which no point of cloud k is.

    Args:
        clouds: The clouds.
        k: Which.
        level: Which grid tells.
        x: Places in the cloud's frame, lanes or a number [m].
        y: Likewise [m].
        z: Likewise [m].

    Returns:
        Lanes or a number [m^2]; at most about T^2.
    """
    inverse, ny, nz = clouds.grids[k, level, 3], clouds.grids[k, level, 6], clouds.grids[k, level, 7]
    u = np.minimum(np.maximum((x - clouds.grids[k, level, 0]) * inverse, 0), clouds.grids[k, level, 5] - 0.01)
    v = np.minimum(np.maximum((y - clouds.grids[k, level, 1]) * inverse, 0), ny - 0.01)
    w = np.minimum(np.maximum((z - clouds.grids[k, level, 2]) * inverse, 0), nz - 0.01)
    a, b, c = np.floor(u), np.floor(v), np.floor(w)
    cell = clouds.begins[k, level] + int((a * ny + b) * nz + c) * 4  # float32 has the integers up to 2^24
    u, v, w = u - a - 0.5, v - b - 0.5, w - c - 0.5
    along = (u + clouds.bounds[cell + 1]) * u + (v + clouds.bounds[cell + 2]) * v
    return (clouds.bounds[cell] + along + (w + clouds.bounds[cell + 3]) * w) * clouds.grids[k, level, 4]


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
    inverse = clouds.numbers[k, 0]
    x0, y0, z0 = x - clouds.grids[k, FINE, 0], y - clouds.grids[k, FINE, 1], z - clouds.grids[k, FINE, 2]
    best = broadcast(f32(1e30), W)
    low = max(int((z0 - far) * inverse), 0)
    high = min(int((z0 + far) * inverse), clouds.counts[k, 2] - 1)
    if low <= high:
        for i in range(
            max(int((x0 - far) * inverse), 0), min(int((x0 + far) * inverse), clouds.counts[k, 0] - 1) + 1
        ):
            for j in range(
                max(int((y0 - far) * inverse), 0), min(int((y0 + far) * inverse), clouds.counts[k, 1] - 1) + 1
            ):
                cell = clouds.counts[k, 3] + (i * clouds.counts[k, 1] + j) * clouds.counts[k, 2]
                for n in range(clouds.starts[cell + low], clouds.starts[cell + high + 1], W):
                    dx = clouds.points[0, n : n + W] - x
                    dy = clouds.points[1, n : n + W] - y
                    dz = clouds.points[2, n : n + W] - z
                    best = np.minimum(best, dx * dx + dy * dy + dz * dz)
                if any_of(best <= enough):
                    return least_of(best)
    return least_of(best)


@procedure
def lane_touches(clouds, k, x, y, z, reach, is_open, W):
    """Whether a sphere touches cloud k in one of some lanes.

    Args:
        clouds: The clouds.
        k: Which.
        x: Centres in the cloud's frame, lanes [m].
        y: Likewise [m].
        z: Likewise [m].
        reach: How near touches: their radius, that of the balls, and a margin [m].
        is_open: The lanes, a mask.
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
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
    """Writes, for each group of spheres, the least distance of one from cloud 0, a lower bound of it where it is far.

    Args:
        clouds: The clouds.
        points: Centres in the cloud's frame, group after group, (groups each, 3) [m].
        radii: Radii in a group, (each,) [m].
        result: Receives the distances, (groups,) [m].
        each: How many spheres a group has.
        W: Lanes, a constant.
    """
    for g in range(len(result)):
        best = f32(1e30)
        for s in range(each):
            n = g * each + s
            least = radii[s] + clouds.numbers[0, 1]
            near = _bound_of(clouds, points[n, 0], points[n, 1], points[n, 2])
            if near - least < best:
                limit = min(clouds.numbers[0, 2], max(best + least, 0.0))
                distance = _distance_of(clouds, points[n, 0], points[n, 1], points[n, 2], near, limit, W)
                best = min(best, distance - least)
        result[g] = best


@procedure
def _bound_of(clouds, x, y, z):
    """A distance below which no point of cloud 0 is."""
    square = least_square(clouds, 0, FINE, x, y, z)
    if square >= clouds.grids[0, FINE, 8] * clouds.grids[0, FINE, 8]:
        square = max(square, least_square(clouds, 0, COARSE, x, y, z))
    return np.sqrt(max(square, 0.0))


@procedure
def _distance_of(clouds, x, y, z, near, limit, W):
    """How far the nearest point of cloud 0 is, where that is below `limit`; no point is nearer than `near`."""
    further = f32(0.01)
    while near < limit:
        look = min(near + further, limit)
        square = nearest_square(clouds, 0, x, y, z, look, 0.0, W)
        if square <= look * look:
            return max(np.sqrt(square), near)
        near, further = look, further * 3.0
    return near
