"""Whether a robot's covering spheres touch obstacles or each other, as procedures: many configurations in lanes.

| symbol | meaning | shape | unit |
|---|---|---|---|
| W | lanes: configurations at once | | |
| G, S | groups of spheres on one body, spheres in all | | |
| R, t | rotation and position of a body | | [1], [m] |
| c | rows of W numbers: R, by rows, and t of each of B bodies; then centres | ((12 B + 3 (G + S)) W,) | [1], [m] |
| box | R, t, half edges h and rounding m of an obstacle: m alone is a ball, h_z and m a capsule | (16,) | [m] |
| cylinder | axis, centre, radius, half length | (8,) | [m] |
| plane | normal, point | (6,) | [m] |

The centres are in the world, three rows each: first those of the groups' bounding spheres, then of all spheres. Three
tests, each only of what passed the one before: (1) a group's axis-aligned box over
all configurations against the obstacles' boxes, a register of obstacles at once; (2) its bounding spheres against the
obstacle; (3) its spheres, whose centres are computed only now. Radii include the margin, so that "free" holds with
rounding in float32; see `tables`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.collision.lanes.primitives import (
    centre,
    near_each_other,
    near_plane,
    near_point,
    place,
    within_obstacle,
)
from ulna.collision.lanes.table_lookup import PairGrids, table_clearance
from ulna.collision.point_grid import Clouds, in_cloud, lane_touches, least_square, level_for
from ulna.compiler.procedures import (
    Array1,
    Array2,
    any_of,
    f32,
    first_of,
    greatest_of,
    lane_numbers,
    least_of,
    procedure,
)

INT = np.int64


class Tables(NamedTuple):
    """What is checked against what.

    Attributes:
        bodies: The first row of the pose of each group's body, (G,).
        first_bound: The row where the centres of bounding spheres begin.
        first_sphere: The row where those of spheres begin.
        known: How many bounding spheres the kernel of poses places.
        bounds: Bounding spheres of the groups: centre on the body and radius, (G, 4) [m].
        first: Where the spheres of a group begin, (G + 1,).
        spheres: Centre on the body and radius, (S, 4) [m].
        spans: How far they reach from the centres of their groups' bounding spheres, (S,) [m].
        columns: The same by columns, for lanes of spheres, with W unused ones at the end, (4, S + W) [m].
        boxes: Rounded boxes, (n, 16) [m].
        cylinders: Cylinders, (m, 8) [m].
        extents: Least and greatest coordinates of boxes, then cylinders, filled up to whole registers, (6, K) [m].
        masks: 1 where an obstacle is checked against a group, else 0, (G, K).
        planes: Half spaces, (p, 6) [m].
        plane_masks: The same for half spaces, (G, p).
        clouds: Obstacles that are points.
        cloud_margins: How far groups must stay from clouds, -1 where they are not checked, (G, clouds) [m].
        pairs: Two groups that are checked against each other, and where their rows begin and end, (P, 4).
        pair_margins: How far they must stay apart, (P,) [m].
        rows: A sphere of the first group, and where its partners begin; one more row ends the last, (N + 1, 2).
        partners: Spheres of the second group that it can meet.
        reach: How far a point of a body moves at most when a joint moves by one, (nq, bodies filled up to whole
            registers) [m/rad], [1].
        grids: Tables of proved clearance of pairs.
    """

    bodies: Array1[INT]
    first_bound: int
    first_sphere: int
    known: int
    bounds: Array2[f32]
    first: Array1[INT]
    spheres: Array2[f32]
    spans: Array1[f32]
    columns: Array2[f32]
    boxes: Array2[f32]
    cylinders: Array2[f32]
    extents: Array2[f32]
    masks: Array2[f32]
    planes: Array2[f32]
    plane_masks: Array2[f32]
    clouds: Clouds
    cloud_margins: Array2[f32]
    pairs: Array2[INT]
    pair_margins: Array1[f32]
    rows: Array2[INT]
    partners: Array1[INT]
    reach: Array2[f32]
    grids: PairGrids


class Work(NamedTuple):
    """Storage that checks write to.

    Attributes:
        q: Configurations, (nq, W) [rad, m].
        c: Poses of the bodies, centres of bounding spheres and of spheres, ((12 B + 3 (G + S)) W,) [1], [m].
        block: How many blocks of configurations were looked at, (1,).
        placed: In which of these the centre of a sphere was last computed, (S,).
    """

    q: Array2[f32]
    c: Array1[f32]
    block: Array1[INT]
    placed: Array1[INT]


@procedure
def bound_row(tables, g):
    """The row of `work.c` with the centre of a group's bounding sphere.

    Args:
        tables: What is checked against what [m].
        g: The group [-].

    Returns:
        The row.
    """
    return tables.first_bound + 3 * g


@procedure
def placed_row(tables, g, s, work, W):
    """The row of a sphere's centre in `work.c`; computes the centre on first use.

    Args:
        tables: What is checked against what [m].
        g: The group [-].
        s: The sphere [-].
        work: Holds the poses; receives the centre [m].
        W: Lanes, a constant [-].

    Returns:
        The row.
    """
    row = tables.first_sphere + 3 * s
    if work.placed[s] != work.block[0]:
        work.placed[s] = work.block[0]
        place(tables.spheres, s, tables.bodies[g], work.c, row, W)
    return row


@procedure
def place_bounds(tables, work, W) -> None:
    """Begins with a block of configurations: computes the centres of bounding spheres that are not known yet.

    Args:
        tables: What is checked against what [m].
        work: Holds the poses; receives the centres [m].
        W: Lanes, a constant [-].
    """
    work.block[0] += 1
    for g in range(tables.known, len(tables.bodies)):
        place(tables.bounds, g, tables.bodies[g], work.c, bound_row(tables, g), W)


@procedure(contract=True)
def on_body(body, c, row, W):
    """The centre of a sphere in the frame of a body, in lanes.

    Args:
        body: The first row of the pose of the body [-].
        c: Poses, twelve rows of W numbers each, and centres, three each [1], [m].
        row: The first row of the sphere [-].
        W: Lanes, a constant [-].

    Returns:
        x, y, z, lanes [m].
    """
    R, t = body * W, (body + 9) * W
    x, y, z = centre(c, row, W)
    x, y, z = x - c[t : t + W], y - c[t + W : t + W + W], z - c[t + 2 * W : t + 2 * W + W]
    return (
        c[R : R + W] * x + c[R + 3 * W : R + 3 * W + W] * y + c[R + 6 * W : R + 6 * W + W] * z,
        c[R + W : R + W + W] * x + c[R + 4 * W : R + 4 * W + W] * y + c[R + 7 * W : R + 7 * W + W] * z,
        c[R + 2 * W : R + 2 * W + W] * x
        + c[R + 5 * W : R + 5 * W + W] * y
        + c[R + 8 * W : R + 8 * W + W] * z,
    )


@procedure
def extent_of(tables, g, r, work, W):
    """The least and greatest coordinates of a group's bounding sphere in all lanes.

    Args:
        tables: What is checked against what [m].
        g: The group [-].
        r: The radius [m].
        work: Holds the centres [m].
        W: Lanes, a constant [-].

    Returns:
        Least x, y, z, greatest x, y, z [m].
    """
    x, y, z = centre(work.c, bound_row(tables, g), W)
    return (
        least_of(x) - r,
        least_of(y) - r,
        least_of(z) - r,
        greatest_of(x) + r,
        greatest_of(y) + r,
        greatest_of(z) + r,
    )


@procedure
def overlapping(tables, g, i, x, y, z, to_x, to_y, to_z, W):
    """Which of W obstacles are checked against a group and overlap a box along the axes.

    Args:
        tables: What is checked against what [m].
        g: The group [-].
        i: The column of the first obstacle [-].
        x: The least coordinates of the box [m].
        y: Likewise [m].
        z: Likewise [m].
        to_x: The greatest coordinates of the box [m].
        to_y: Likewise [m].
        to_z: Likewise [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    return (
        (tables.extents[0, i : i + W] <= to_x)
        & (tables.extents[1, i : i + W] <= to_y)
        & (tables.extents[2, i : i + W] <= to_z)
        & (tables.extents[3, i : i + W] >= x)
        & (tables.extents[4, i : i + W] >= y)
        & (tables.extents[5, i : i + W] >= z)
        & (tables.masks[g, i : i + W] > 0)
    )


@procedure
def _group_touches(tables, g, k, work, W):
    """Whether a group touches the obstacle of column k in any lane."""
    x, y, z = centre(work.c, bound_row(tables, g), W)
    if any_of(within_obstacle(tables, k, x, y, z, tables.bounds[g, 3])):
        for s in range(tables.first[g], tables.first[g + 1]):
            x, y, z = centre(work.c, placed_row(tables, g, s, work, W), W)
            if any_of(within_obstacle(tables, k, x, y, z, tables.spheres[s, 3])):
                return True
    return False


@procedure
def _group_touches_world(tables, g, work, W):
    """Whether a group touches an obstacle in any lane."""
    r = tables.bounds[g, 3]
    x, y, z, to_x, to_y, to_z = extent_of(tables, g, r, work, W)
    for i in range(0, tables.extents.shape[1], W):
        overlap = overlapping(tables, g, i, x, y, z, to_x, to_y, to_z, W)
        while any_of(overlap):
            lane = first_of(overlap)
            if _group_touches(tables, g, i + lane, work, W):
                return True
            overlap = overlap & (lane_numbers(W) != lane)
    for k in range(len(tables.planes)):
        if tables.plane_masks[g, k] > 0 and any_of(
            near_plane(tables.planes, k, work.c, bound_row(tables, g), r, W)
        ):
            for s in range(tables.first[g], tables.first[g + 1]):
                row = placed_row(tables, g, s, work, W)
                if any_of(near_plane(tables.planes, k, work.c, row, tables.spheres[s, 3], W)):
                    return True
    return False


@procedure
def lanes_near_cloud(tables, k, row, reach, work, W):
    """Squares below which a sphere's centres are not from the points of a cloud, and the centres in its frame.

    Args:
        tables: What is checked against what [m].
        k: The cloud [-].
        row: The row of the centres in `work.c` [-].
        reach: The distance that is asked for [m].
        work: Holds the centres [m].
        W: Lanes, a constant [-].

    Returns:
        The squares, and x, y, z, lanes [m^2], [m].
    """
    x, y, z = in_cloud(tables.clouds.poses, k, work.c, row, W)
    return least_square(tables.clouds, k, level_for(tables.clouds, k, reach), x, y, z), x, y, z


@procedure
def _group_touches_cloud(tables, g, k, work, W):
    """Whether a group touches a cloud in any lane."""
    apart = tables.cloud_margins[g, k] + tables.clouds.numbers[k, 1]
    reach = tables.bounds[g, 3] + apart
    square, x, y, z = lanes_near_cloud(tables, k, bound_row(tables, g), reach, work, W)
    if any_of(square <= reach * reach):
        for s in range(tables.first[g], tables.first[g + 1]):
            span = tables.spans[s] + apart
            is_open = square <= span * span
            if any_of(is_open):
                row, reach = placed_row(tables, g, s, work, W), tables.spheres[s, 3] + apart
                near, x, y, z = lanes_near_cloud(tables, k, row, reach, work, W)
                is_open = is_open & (near <= reach * reach)
                if lane_touches(tables.clouds, k, x, y, z, reach, is_open, W):
                    return True
    return False


@procedure
def pair_in_doubt(tables, k, work, W):
    """The lanes in which bounding spheres of a pair touch, and no table proves that the links do not.

    Args:
        tables: What is checked against what [m].
        k: The pair [-].
        work: Holds configurations and poses [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    a, b = tables.pairs[k, 0], tables.pairs[k, 1]
    bound = tables.bounds[a, 3] + tables.bounds[b, 3] + tables.pair_margins[k]
    in_doubt = near_each_other(work.c, bound_row(tables, a), bound_row(tables, b), bound, W)
    g = tables.grids.of_pair[k]
    if g >= 0 and any_of(in_doubt):
        in_doubt = in_doubt & (table_clearance(tables.grids, g, work.q, W) <= tables.grids.pair_reach[k])
    return in_doubt


@procedure
def _pair_touches(tables, k, work, W):
    """Whether groups of a pair touch, or come nearer than they may, in any lane."""
    in_doubt = pair_in_doubt(tables, k, work, W)
    if not any_of(in_doubt):
        return False
    a, b = tables.pairs[k, 0], tables.pairs[k, 1]
    bound = tables.bounds[b, 3] + tables.pair_margins[k]
    x, y, z = on_body(tables.bodies[a], work.c, bound_row(tables, b), W)
    for n in range(tables.pairs[k, 2], tables.pairs[k, 3]):
        i = tables.rows[n, 0]
        if any_of(near_point(tables.spheres, i, x, y, z, bound, W) & in_doubt):
            r = tables.spheres[i, 3]
            row = placed_row(tables, a, i, work, W)
            for m in range(tables.rows[n, 1], tables.rows[n + 1, 1]):
                j = tables.partners[m]
                reach = r + tables.spheres[j, 3] + tables.pair_margins[k]
                other = placed_row(tables, b, j, work, W)
                if any_of(near_each_other(work.c, row, other, reach, W) & in_doubt):
                    return True
    return False


@procedure
def block_touches(tables, work, W):
    """Whether anything touches in any of the configurations whose poses are given.

    Args:
        tables: What is checked against what.
        work: Holds the poses; the rest is overwritten.
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
    place_bounds(tables, work, W)
    # Last to first: the last links of an arm move farthest, and the first contact ends the check.
    for i in range(len(tables.bodies)):
        if _group_touches_world(tables, len(tables.bodies) - 1 - i, work, W):
            return True
    if len(tables.clouds.poses) > 0:
        for i in range(len(tables.bodies)):
            g = len(tables.bodies) - 1 - i
            for k in range(len(tables.clouds.poses)):
                if tables.cloud_margins[g, k] >= 0 and _group_touches_cloud(tables, g, k, work, W):
                    return True
    for k in range(len(tables.grids.fixed)):
        apart = table_clearance(tables.grids, tables.grids.fixed[k], work.q, W)
        if any_of(apart <= tables.grids.fixed_reach[k]):
            return True
    for k in range(len(tables.pairs)):  # noqa: SIM110  # a loop of the language
        if _pair_touches(tables, k, work, W):
            return True
    return False
