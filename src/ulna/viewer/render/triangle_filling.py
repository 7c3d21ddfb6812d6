"""Triangles are filled into a z-buffer by a procedure: row by row, so that slivers cost what they cover."""

from __future__ import annotations

import numpy as np

from ulna.compiler.procedures import Array1, Array2, Array3, f32, f64, procedure

INT = np.int64


@procedure
def _slope(x_from, y_from, x_to, y_to):
    """dx / dy of an edge, 0 where it is level."""
    dy = y_to - y_from
    slope = 0.0
    if abs(dy) >= 1e-12:
        slope = (x_to - x_from) / dy
    return slope


@procedure
def _side(y_from, y_to, area):
    """Whether an edge bounds rows from the left (-1) or from the right (1); 0 where it is level."""
    dy = y_to - y_from
    side = 0
    if abs(dy) >= 1e-12:
        side = 1 if dy * area > 0.0 else -1
    return side


@procedure
def _fill_row(row, low, high, at_left, across, owner, depth, owners, width):
    """Enters the samples of a row whose middles lie between two places; `at_left` is the nearness at its left end."""
    first, last = int(max(np.ceil(low - 0.5), 0.0)), int(min(np.floor(high - 0.5), width - 1.0))
    at_first = at_left + (first + 0.5) * across
    for column in range(first, last + 1):
        near = f32(max(at_first + (column - first) * across, 1e-30))
        at = row * width + column
        if near > depth[at] or (near == depth[at] and owner > owners[at]):
            depth[at] = near
            owners[at] = owner


@procedure
def _fill_triangle(corner, near, area, top, bottom, owner, depth, owners, width):
    """Enters the rows of a triangle with corners (3, 2) from the row `top` to the row `bottom`."""
    xa, ya, xb, yb, xc, yc = (
        corner[0, 0],
        corner[0, 1],
        corner[1, 0],
        corner[1, 1],
        corner[2, 0],
        corner[2, 1],
    )
    one, two = near[1] - near[0], near[2] - near[0]
    # nearness over the screen: origin + x across + y down
    across = (one * (yc - ya) - two * (yb - ya)) / area
    down = (two * (xb - xa) - one * (xc - xa)) / area
    origin = near[0] - xa * across - ya * down
    slope_a, side_a = _slope(xa, ya, xb, yb), _side(ya, yb, area)
    slope_b, side_b = _slope(xb, yb, xc, yc), _side(yb, yc, area)
    slope_c, side_c = _slope(xc, yc, xa, ya), _side(yc, ya, area)
    for row in range(top, bottom + 1):
        y = row + 0.5
        a, b, c = (
            xa - slope_a * ya + slope_a * y,
            xb - slope_b * yb + slope_b * y,
            xc - slope_c * yc + slope_c * y,
        )
        least, most = -0.5, width - 0.5
        low = max(least, a if side_a < 0 else least, b if side_b < 0 else least, c if side_c < 0 else least)
        high = min(most, a if side_a > 0 else most, b if side_b > 0 else most, c if side_c > 0 else most)
        _fill_row(row, low, high, origin + y * down, across, owner, depth, owners, width)


@procedure
def fill_triangles(
    points: Array3[f64],
    nearness: Array2[f64],
    owner: Array1[INT],
    depth: Array1[f32],
    owners: Array1[INT],
    width: int,
    height: int,
) -> int:
    """Enter triangles into a z-buffer where they are nearer than what is there.

    Of triangles that are equally near the one with the larger owner is seen. A triangle covers samples whose middle is
    inside of it.

    Args:
        points: Corners on the screen in samples, x to the right and y down, (m, 3, 2).
        nearness: A positive number at each corner that is linear on the screen and larger nearer by, (m, 3).
        owner: A number for each triangle, (m,).
        depth: Nearness of what is seen, 0 for nothing, (height * width,); changed.
        owners: Its owner, (height * width,); changed.
        width: Samples across.
        height: Samples down.

    Returns:
        How many triangles reach into the picture.
    """
    count = 0
    for t in range(len(owner)):
        xa, ya = points[t, 0, 0], points[t, 0, 1]
        xb, yb = points[t, 1, 0], points[t, 1, 1]
        xc, yc = points[t, 2, 0], points[t, 2, 1]
        area = (xb - xa) * (yc - ya) - (yb - ya) * (xc - xa)
        top = max(np.ceil(min(ya, yb, yc) - 0.5), 0.0)
        bottom = min(np.floor(max(ya, yb, yc) - 0.5), height - 1.0)
        left = max(np.ceil(min(xa, xb, xc) - 0.5), 0.0)
        right = min(np.floor(max(xa, xb, xc) - 0.5), width - 1.0)
        if abs(area) > 1e-9 and top <= bottom and left <= right:
            count += 1
            _fill_triangle(
                points[t], nearness[t], area, int(top), int(bottom), owner[t], depth, owners, width
            )
    return count
