"""Whether a robot's covering spheres touch obstacles or each other, as procedures: many configurations in lanes.

| symbol | meaning | shape | unit |
|---|---|---|---|
| W | lanes: configurations at once | | |
| c | centres of spheres in the world, three rows each, the links' bounding spheres first | (3 (L + S), W) | [m] |
| L, S | links with spheres, spheres in all | | |
| box | R, t, half edges h and rounding m of an obstacle: m alone is a ball, h_z and m a capsule | (16,) | [m] |
| cylinder | axis, centre, radius, half length | (8,) | [m] |
| plane | normal, point | (6,) | [m] |

A point p of an obstacle's frame is as far as the part of abs(p) - h above 0 (Ericson, Real-Time Collision Detection
2005, section 5.1). Each link has a bounding sphere: only where that touches, its spheres are looked at. Radii include
the margin, so that "free" holds with rounding in float32; see `tables`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ulna.compiler.procedures import Array1, Array2, any_of, f32, procedure

INT = np.int64


class Tables(NamedTuple):
    """What is checked against what.

    Attributes:
        bounds: Radii of the links' bounding spheres, (L,) [m].
        radii: Radii of the spheres, (S,) [m].
        first: Where the spheres of a link begin, (L + 1,).
        boxes: Rounded boxes, (n, 16) [m].
        box_links: Whether a box is checked against a link, (n, L).
        cylinders: Cylinders, (n, 8) [m].
        cylinder_links: Whether a cylinder is checked against a link, (n, L).
        planes: Half spaces, (n, 6) [m].
        plane_links: Whether a plane is checked against a link, (n, L).
        pairs: Links that are checked against each other, (n, 2).
    """

    bounds: Array1[f32]
    radii: Array1[f32]
    first: Array1[INT]
    boxes: Array2[f32]
    box_links: Array2[INT]
    cylinders: Array2[f32]
    cylinder_links: Array2[INT]
    planes: Array2[f32]
    plane_links: Array2[INT]
    pairs: Array2[INT]


@procedure(contract=True)
def _near_box(boxes, k, c, row, r, W):
    """Whether spheres touch a rounded box, in lanes."""
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
def _near_cylinder(cylinders, k, c, row, r, W):
    """Whether spheres touch a cylinder, in lanes."""
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
def _near_plane(planes, k, c, row, r, W):
    """Whether spheres touch a half space, in lanes."""
    x = c[row, 0:W] - planes[k, 3]
    y = c[row + 1, 0:W] - planes[k, 4]
    z = c[row + 2, 0:W] - planes[k, 5]
    return x * planes[k, 0] + y * planes[k, 1] + z * planes[k, 2] <= r


@procedure(contract=True)
def _near_each_other(c, a, b, r, W):
    """Whether two spheres touch, in lanes."""
    x = c[a, 0:W] - c[b, 0:W]
    y = c[a + 1, 0:W] - c[b + 1, 0:W]
    z = c[a + 2, 0:W] - c[b + 2, 0:W]
    return x * x + y * y + z * z <= r * r


@procedure
def _link_touches_world(tables, link, c, W):
    """Whether a link touches an obstacle in any lane."""
    links = len(tables.bounds)
    bound = tables.bounds[link]
    for k in range(len(tables.boxes)):
        if tables.box_links[k, link] == 1 and any_of(_near_box(tables.boxes, k, c, 3 * link, bound, W)):
            for s in range(tables.first[link], tables.first[link + 1]):
                if any_of(_near_box(tables.boxes, k, c, 3 * (links + s), tables.radii[s], W)):
                    return True
    for k in range(len(tables.cylinders)):
        if tables.cylinder_links[k, link] == 1 and any_of(
            _near_cylinder(tables.cylinders, k, c, 3 * link, bound, W)
        ):
            for s in range(tables.first[link], tables.first[link + 1]):
                if any_of(_near_cylinder(tables.cylinders, k, c, 3 * (links + s), tables.radii[s], W)):
                    return True
    for k in range(len(tables.planes)):
        if tables.plane_links[k, link] == 1 and any_of(_near_plane(tables.planes, k, c, 3 * link, bound, W)):
            for s in range(tables.first[link], tables.first[link + 1]):
                if any_of(_near_plane(tables.planes, k, c, 3 * (links + s), tables.radii[s], W)):
                    return True
    return False


@procedure
def _links_touch(tables, a, b, c, W):
    """Whether two links touch in any lane."""
    links = len(tables.bounds)
    if not any_of(_near_each_other(c, 3 * a, 3 * b, tables.bounds[a] + tables.bounds[b], W)):
        return False
    for i in range(tables.first[a], tables.first[a + 1]):
        r = tables.radii[i]
        if any_of(_near_each_other(c, 3 * (links + i), 3 * b, r + tables.bounds[b], W)):
            for j in range(tables.first[b], tables.first[b + 1]):
                if any_of(_near_each_other(c, 3 * (links + i), 3 * (links + j), r + tables.radii[j], W)):
                    return True
    return False


@procedure
def block_touches(tables, c, W):
    """Whether anything touches in any of the configurations whose spheres `c` holds.

    Args:
        tables: What is checked against what.
        c: Centres, shape (3 (L + S), W) [m].
        W: Lanes, a constant.

    Returns:
        The truth value.
    """
    for link in range(len(tables.bounds)):
        if _link_touches_world(tables, link, c, W):
            return True
    for k in range(len(tables.pairs)):  # noqa: SIM110  # a loop of the language
        if _links_touch(tables, tables.pairs[k, 0], tables.pairs[k, 1], c, W):
            return True
    return False
