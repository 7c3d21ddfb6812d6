"""Whether spheres touch one obstacle, or one another, as procedures: in lanes; symbols as in `touching.py`.

In a box's frame the distance of a point p from the box is the norm of max(abs(p) - h, 0) (Ericson, Real-Time Collision
Detection 2005, section 5.1).
"""

from __future__ import annotations

import numpy as np

from ulna.compiler.procedures import procedure


@procedure(contract=True)
def place(table, k, body, c, row, W) -> None:
    """Writes the centre of row k of a table of spheres to c, in lanes.

    Args:
        table: Centres on bodies, (n, 4) [m].
        k: The row [-].
        body: The first row of the pose of the sphere's body [-].
        c: Holds the poses, receives the centres, three rows of W numbers each [m].
        row: The row of `c` to begin with [-].
        W: Lanes, a constant [-].
    """
    x, y, z = table[k, 0], table[k, 1], table[k, 2]
    for i in range(3):
        R, t, to = (body + 3 * i) * W, (body + 9 + i) * W, (row + i) * W
        turned = c[R : R + W] * x + c[R + W : R + W + W] * y + c[R + 2 * W : R + 2 * W + W] * z
        c[to : to + W] = turned + c[t : t + W]


@procedure
def centre(c, row, W):
    """The centre of a sphere, in lanes.

    Args:
        c: Centres, three rows of W numbers each [m].
        row: The first row of the sphere [-].
        W: Lanes, a constant [-].

    Returns:
        x, y, z, lanes [m].
    """
    at = row * W
    return c[at : at + W], c[at + W : at + W + W], c[at + 2 * W : at + 2 * W + W]


@procedure(contract=True)
def _within_box(boxes, k, x, y, z, r):
    """Whether spheres touch a rounded box, in lanes.

    Args:
        boxes: Numbers of the obstacles, (n, 16) [m].
        k: Which obstacle [-].
        x: Centres [m].
        y: Likewise [m].
        z: Likewise [m].
        r: Their radii, or the radius of all [m].

    Returns:
        A mask.
    """
    x, y, z = x - boxes[k, 9], y - boxes[k, 10], z - boxes[k, 11]
    px = abs(boxes[k, 0] * x + boxes[k, 3] * y + boxes[k, 6] * z) - boxes[k, 12]
    py = abs(boxes[k, 1] * x + boxes[k, 4] * y + boxes[k, 7] * z) - boxes[k, 13]
    pz = abs(boxes[k, 2] * x + boxes[k, 5] * y + boxes[k, 8] * z) - boxes[k, 14]
    px, py, pz = np.maximum(px, 0), np.maximum(py, 0), np.maximum(pz, 0)
    reach = r + boxes[k, 15]
    return px * px + py * py + pz * pz <= reach * reach


@procedure(contract=True)
def _within_cylinder(cylinders, k, x, y, z, r):
    """Whether spheres touch a cylinder, in lanes.

    Args:
        cylinders: Numbers of the obstacles, (n, 8) [m].
        k: Which obstacle [-].
        x: Centres [m].
        y: Likewise [m].
        z: Likewise [m].
        r: Their radii, or the radius of all [m].

    Returns:
        A mask.
    """
    x, y, z = x - cylinders[k, 3], y - cylinders[k, 4], z - cylinders[k, 5]
    along = x * cylinders[k, 0] + y * cylinders[k, 1] + z * cylinders[k, 2]
    x = x - along * cylinders[k, 0]
    y = y - along * cylinders[k, 1]
    z = z - along * cylinders[k, 2]
    aside = np.maximum(np.sqrt(x * x + y * y + z * z) - cylinders[k, 6], 0)
    above = np.maximum(abs(along) - cylinders[k, 7], 0)
    return aside * aside + above * above <= r * r


@procedure(contract=True)
def within_obstacle(tables, k, x, y, z, r):
    """Whether spheres touch the obstacle of column k, a rounded box or a cylinder, in lanes.

    Args:
        tables: What is checked against what [m].
        k: The column [-].
        x: Centres [m].
        y: Likewise [m].
        z: Likewise [m].
        r: Their radii, or the radius of all [m].

    Returns:
        A mask.
    """
    if k < len(tables.boxes):
        return _within_box(tables.boxes, k, x, y, z, r)
    return _within_cylinder(tables.cylinders, k - len(tables.boxes), x, y, z, r)


@procedure(contract=True)
def near_plane(planes, k, c, row, r, W):
    """Whether spheres touch a half space, in lanes.

    Args:
        planes: Numbers of the obstacles, (n, 6) [m].
        k: Which obstacle [-].
        c: Centres, three rows of W numbers each [m].
        row: The first row of the spheres [-].
        r: Their radius [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    x, y, z = centre(c, row, W)
    x, y, z = x - planes[k, 3], y - planes[k, 4], z - planes[k, 5]
    return x * planes[k, 0] + y * planes[k, 1] + z * planes[k, 2] <= r


@procedure(contract=True)
def near_each_other(c, a, b, r, W):
    """Whether two spheres touch, in lanes.

    Args:
        c: Centres, three rows of W numbers each [m].
        a: The first row of one sphere [-].
        b: That of the other [-].
        r: The sum of their radii [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    ax, ay, az = centre(c, a, W)
    bx, by, bz = centre(c, b, W)
    x, y, z = ax - bx, ay - by, az - bz
    return x * x + y * y + z * z <= r * r


@procedure(contract=True)
def near_point(spheres, k, x, y, z, r, W):
    """Whether a sphere touches others, in lanes; all in the frame of its body.

    Args:
        spheres: Centres on bodies and radii, (n, 4) [m].
        k: The sphere [-].
        x: Centres of the others [m].
        y: Likewise [m].
        z: Likewise [m].
        r: Their radius [m].
        W: Lanes, a constant [-].

    Returns:
        A mask.
    """
    x, y, z, reach = x - spheres[k, 0], y - spheres[k, 1], z - spheres[k, 2], r + spheres[k, 3]
    return x * x + y * y + z * z <= reach * reach
