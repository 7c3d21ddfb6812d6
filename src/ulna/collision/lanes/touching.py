"""Whether a robot's covering spheres touch obstacles or each other, as procedures: many configurations in lanes.

| symbol | meaning | shape | unit |
|---|---|---|---|
| W | lanes: configurations at once | | |
| G, S | groups of spheres on one body, spheres in all | | |
| pose | R, by rows, and t of each body | (12 B, W) | [1], [m] |
| c | centres in the world, three rows each: bounding spheres of the groups, then all spheres | (3 (G + S), W) | [m] |
| box | R, t, half edges h and rounding m of an obstacle: m alone is a ball, h_z and m a capsule | (16,) | [m] |
| cylinder | axis, centre, radius, half length | (8,) | [m] |
| plane | normal, point | (6,) | [m] |

In a box's frame the distance of a point p from the box is the norm of max(abs(p) - h, 0) (Ericson, Real-Time Collision
Detection 2005, section 5.1). Three tests, each only of what passed the one before: (1) a group's axis-aligned box over
all configurations against the obstacles' boxes, a register of obstacles at once; (2) its bounding spheres against the
obstacle; (3) its spheres, whose centres are computed only now. Radii include the margin, so that "free" holds with
rounding in float32; see `tables`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.collision.point_grid import Clouds, in_cloud, lane_touches, maybe_near
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
        bounds: Bounding spheres of the groups: centre on the body and radius, (G, 4) [m].
        first: Where the spheres of a group begin, (G + 1,).
        spheres: Centre on the body and radius, (S, 4) [m].
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
    """

    bodies: Array1[INT]
    bounds: Array2[f32]
    first: Array1[INT]
    spheres: Array2[f32]
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


class Work(NamedTuple):
    """Storage that checks write to.

    Attributes:
        q: Configurations, (nq, W) [rad, m].
        pose: Poses of the bodies, (12 B, W) [1], [m].
        c: Centres of bounding spheres and spheres, (3 (G + S), W) [m].
        is_placed: 1 where the centre of a sphere is computed, else 0, (S,).
    """

    q: Array2[f32]
    pose: Array2[f32]
    c: Array2[f32]
    is_placed: Array1[INT]


@procedure(contract=True)
def place(table, k, pose, body, c, row, W) -> None:
    """Writes the centre of row k of a table of spheres to c, in lanes.

    Args:
        table: Centres on bodies, (n, 4) [m].
        k: The row [-].
        pose: Poses of the bodies, (12 B, W) [1], [m].
        body: The first row of the pose of the sphere's body [-].
        c: Receives the centres, three rows each, (rows, W) [m].
        row: The row of `c` to begin with [-].
        W: Lanes, a constant [-].
    """
    for i in range(3):
        c[row + i, 0:W] = (
            pose[body + 3 * i, 0:W] * table[k, 0]
            + pose[body + 3 * i + 1, 0:W] * table[k, 1]
            + pose[body + 3 * i + 2, 0:W] * table[k, 2]
            + pose[body + 9 + i, 0:W]
        )


@procedure(contract=True)
def near_box(boxes, k, c, row, r, W):
    """Whether spheres touch a rounded box, in lanes.

    Args:
        boxes: Numbers of the obstacles, (n, 16) [m].
        k: Which obstacle [-].
        c: Centres, three rows each, (rows, W) [m].
        row: The first row of the spheres [-].
        r: Their radius [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    x = c[row, 0:W] - boxes[k, 9]
    y = c[row + 1, 0:W] - boxes[k, 10]
    z = c[row + 2, 0:W] - boxes[k, 11]
    px = abs(boxes[k, 0] * x + boxes[k, 3] * y + boxes[k, 6] * z) - boxes[k, 12]
    py = abs(boxes[k, 1] * x + boxes[k, 4] * y + boxes[k, 7] * z) - boxes[k, 13]
    pz = abs(boxes[k, 2] * x + boxes[k, 5] * y + boxes[k, 8] * z) - boxes[k, 14]
    px, py, pz = np.maximum(px, 0), np.maximum(py, 0), np.maximum(pz, 0)
    reach = r + boxes[k, 15]
    return px * px + py * py + pz * pz <= reach * reach


@procedure(contract=True)
def near_cylinder(cylinders, k, c, row, r, W):
    """Whether spheres touch a cylinder, in lanes.

    Args:
        cylinders: Numbers of the obstacles, (n, 8) [m].
        k: Which obstacle [-].
        c: Centres, three rows each, (rows, W) [m].
        row: The first row of the spheres [-].
        r: Their radius [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    x = c[row, 0:W] - cylinders[k, 3]
    y = c[row + 1, 0:W] - cylinders[k, 4]
    z = c[row + 2, 0:W] - cylinders[k, 5]
    along = x * cylinders[k, 0] + y * cylinders[k, 1] + z * cylinders[k, 2]
    x = x - along * cylinders[k, 0]
    y = y - along * cylinders[k, 1]
    z = z - along * cylinders[k, 2]
    aside = np.maximum(np.sqrt(x * x + y * y + z * z) - cylinders[k, 6], 0)
    above = np.maximum(abs(along) - cylinders[k, 7], 0)
    return aside * aside + above * above <= r * r


@procedure(contract=True)
def near_plane(planes, k, c, row, r, W):
    """Whether spheres touch a half space, in lanes.

    Args:
        planes: Numbers of the obstacles, (n, 6) [m].
        k: Which obstacle [-].
        c: Centres, three rows each, (rows, W) [m].
        row: The first row of the spheres [-].
        r: Their radius [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    x = c[row, 0:W] - planes[k, 3]
    y = c[row + 1, 0:W] - planes[k, 4]
    z = c[row + 2, 0:W] - planes[k, 5]
    return x * planes[k, 0] + y * planes[k, 1] + z * planes[k, 2] <= r


@procedure(contract=True)
def near_each_other(c, a, b, r, W):
    """Whether two spheres touch, in lanes.

    Args:
        c: Centres, three rows each, (rows, W) [m].
        a: The first row of one sphere [-].
        b: That of the other [-].
        r: The sum of their radii [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    x = c[a, 0:W] - c[b, 0:W]
    y = c[a + 1, 0:W] - c[b + 1, 0:W]
    z = c[a + 2, 0:W] - c[b + 2, 0:W]
    return x * x + y * y + z * z <= r * r


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
    row = 3 * (len(tables.bodies) + s)
    if work.is_placed[s] == 0:
        work.is_placed[s] = 1
        place(tables.spheres, s, work.pose, tables.bodies[g], work.c, row, W)
    return row


@procedure
def _group_touches(tables, g, k, work, W):
    """Whether a group touches the obstacle of column k in any lane."""
    boxes = len(tables.boxes)
    if k < boxes:
        if any_of(near_box(tables.boxes, k, work.c, 3 * g, tables.bounds[g, 3], W)):
            for s in range(tables.first[g], tables.first[g + 1]):
                row = placed_row(tables, g, s, work, W)
                if any_of(near_box(tables.boxes, k, work.c, row, tables.spheres[s, 3], W)):
                    return True
    else:
        n = k - boxes
        if any_of(near_cylinder(tables.cylinders, n, work.c, 3 * g, tables.bounds[g, 3], W)):
            for s in range(tables.first[g], tables.first[g + 1]):
                row = placed_row(tables, g, s, work, W)
                if any_of(near_cylinder(tables.cylinders, n, work.c, row, tables.spheres[s, 3], W)):
                    return True
    return False


@procedure
def _group_touches_world(tables, g, work, W):
    """Whether a group touches an obstacle in any lane."""
    r = tables.bounds[g, 3]
    least_x, greatest_x = least_of(work.c[3 * g, 0:W]) - r, greatest_of(work.c[3 * g, 0:W]) + r
    least_y, greatest_y = least_of(work.c[3 * g + 1, 0:W]) - r, greatest_of(work.c[3 * g + 1, 0:W]) + r
    least_z, greatest_z = least_of(work.c[3 * g + 2, 0:W]) - r, greatest_of(work.c[3 * g + 2, 0:W]) + r
    for i in range(0, tables.extents.shape[1], W):
        overlap = (
            (tables.extents[0, i : i + W] <= greatest_x)
            & (tables.extents[1, i : i + W] <= greatest_y)
            & (tables.extents[2, i : i + W] <= greatest_z)
            & (tables.extents[3, i : i + W] >= least_x)
            & (tables.extents[4, i : i + W] >= least_y)
            & (tables.extents[5, i : i + W] >= least_z)
            & (tables.masks[g, i : i + W] > 0)
        )
        while any_of(overlap):
            lane = first_of(overlap)
            if _group_touches(tables, g, i + lane, work, W):
                return True
            overlap = overlap & (lane_numbers(W) != lane)
    for k in range(len(tables.planes)):
        if tables.plane_masks[g, k] > 0 and any_of(near_plane(tables.planes, k, work.c, 3 * g, r, W)):
            for s in range(tables.first[g], tables.first[g + 1]):
                row = placed_row(tables, g, s, work, W)
                if any_of(near_plane(tables.planes, k, work.c, row, tables.spheres[s, 3], W)):
                    return True
    return False


@procedure
def _group_touches_clouds(tables, g, work, W):
    """Whether a group touches a cloud in any lane."""
    begin = tables.first[g]
    for k in range(len(tables.clouds.poses)):
        margin = tables.cloud_margins[g, k]
        if margin >= 0:
            for s in range(begin - 1, tables.first[g + 1]):  # first the bounding sphere
                row, r = 3 * g, tables.bounds[g, 3] + margin
                if s >= begin:
                    row, r = placed_row(tables, g, s, work, W), tables.spheres[s, 3] + margin
                x, y, z = in_cloud(tables.clouds.poses, k, work.c, row, W)
                undecided = maybe_near(tables.clouds, k, x, y, z, r, W)
                if s < begin:
                    if not any_of(undecided):
                        break
                elif lane_touches(tables.clouds, k, x, y, z, r, undecided, W):
                    return True
    return False


@procedure
def _pair_touches(tables, k, work, W):
    """Whether spheres of the groups of a pair touch, or come nearer than they may, in any lane."""
    a, b = tables.pairs[k, 0], tables.pairs[k, 1]
    bound = tables.bounds[b, 3] + tables.pair_margins[k]
    if not any_of(near_each_other(work.c, 3 * a, 3 * b, tables.bounds[a, 3] + bound, W)):
        return False
    for n in range(tables.pairs[k, 2], tables.pairs[k, 3]):
        i = tables.rows[n, 0]
        r = tables.spheres[i, 3]
        row = placed_row(tables, a, i, work, W)
        if any_of(near_each_other(work.c, row, 3 * b, r + bound, W)):
            for m in range(tables.rows[n, 1], tables.rows[n + 1, 1]):
                j = tables.partners[m]
                reach = r + tables.spheres[j, 3] + tables.pair_margins[k]
                other = placed_row(tables, b, j, work, W)
                if any_of(near_each_other(work.c, row, other, reach, W)):
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
    for s in range(len(tables.spheres)):
        work.is_placed[s] = 0
    for g in range(len(tables.bodies)):
        place(tables.bounds, g, work.pose, tables.bodies[g], work.c, 3 * g, W)
    # Last to first: the last links of an arm move farthest, and the first contact ends the check.
    for i in range(len(tables.bodies)):
        if _group_touches_world(tables, len(tables.bodies) - 1 - i, work, W):
            return True
    if len(tables.clouds.poses) > 0:
        for i in range(len(tables.bodies)):
            if _group_touches_clouds(tables, len(tables.bodies) - 1 - i, work, W):
                return True
    for k in range(len(tables.pairs)):  # noqa: SIM110  # a loop of the language
        if _pair_touches(tables, k, work, W):
            return True
    return False
