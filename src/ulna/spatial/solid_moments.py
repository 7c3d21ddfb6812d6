"""Volume and moments of a solid inside a closed surface of triangles.

| symbol | meaning | unit | equation |
|---|---|---|---|
| a, b, c | corners of a triangle, from the mean of all corners | m | |
| v | six times the signed volume of the tetrahedron 0, a, b, c | m^3 | v = a . (b x c) |
| V | volume | m^3 | V = sum v / 6 |
| V r | first moments | m^4 | V r = sum v (a + b + c) / 24 |
| S | second moments about the origin | m^5 | S = sum v (a a' + b b' + c c' + s s') / 120, s = a + b + c |

Source: Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor in terms of its vertex coordinates (2005).
"""

from __future__ import annotations

import numpy as np

from ulna.checks.arrays import check_finite, real_array
from ulna.errors import InputError, ShapeError
from ulna.typing import Array, ArrayLike, Floats

_FLAT = 1e-9
"""A solid fills at least this part of the cube around its corners, or rounding decides its moments."""


def solid_moments(vertices: ArrayLike, triangles: ArrayLike) -> tuple[float, Floats, Floats]:
    """Volume, centre and second moments of the solid inside a closed surface.

    Args:
        vertices: Corners, shape (n, 3) [m].
        triangles: The corners of each triangle, all in one direction of rotation seen from outside, shape (m, 3).

    Returns:
        The volume [m^3], the centre of volume (3,) [m], and the second moments about it (3, 3) [m^5].

    Raises:
        ShapeError: If an array has another shape.
        InputError: If the surface encloses no volume or is not closed.
    """
    corners, faces = _checked(vertices, triangles)
    if not is_closed(corners, faces):
        raise InputError(
            "The surface is not closed, or its triangles do not all turn the same way. Each edge must be shared by two "
            "triangles that run along it in opposite directions. Repair the mesh, or take its convex hull."
        )
    middle = corners.mean(axis=0)
    points = corners - middle
    size = float(np.ptp(corners, axis=0).max())
    a, b, c = (points[faces[:, k]] for k in range(3))
    v = (a * np.cross(b, c)).sum(axis=1)
    volume = float(v.sum()) / 6.0
    if abs(volume) <= _FLAT * size**3:
        raise InputError(
            f"The surface encloses {abs(volume):.3g} m^3, which is no volume at a size of {size:.3g} m."
        )
    s = a + b + c
    centre = (v @ s) / (24.0 * volume)
    second = sum((x * v[:, None]).T @ x for x in (a, b, c, s)) / 120.0 - volume * np.outer(centre, centre)
    return abs(volume), middle + centre, second * np.sign(volume)


def is_closed(vertices: Floats, triangles: Array) -> bool:
    """Whether a surface is closed: each edge of a triangle is one of a neighbour's, in the opposite direction.

    Args:
        vertices: Corners, shape (n, 3) [m]; equal ones count as one.
        triangles: The corners of each triangle, shape (m, 3).

    Returns:
        Whether it is.
    """
    distinct, place = np.unique(vertices, axis=0, return_inverse=True)
    faces = place.reshape(-1)[triangles]
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    used = start != end  # triangles with two equal corners have no area
    forward = np.sort(start[used] * len(distinct) + end[used])
    backward = np.sort(end[used] * len(distinct) + start[used])
    return bool(used.any() and (forward == backward).all())


def _checked(vertices: ArrayLike, triangles: ArrayLike) -> tuple[Floats, Array]:
    corners = real_array("vertices", vertices)
    faces = np.asarray(triangles)
    for name, array in (("vertices", corners), ("triangles", faces)):
        if array.ndim != 2 or array.shape[1] != 3 or not len(array):
            raise ShapeError(name, array.shape, "(n, 3)")
    check_finite("vertices", corners)
    if faces.dtype.kind not in "iu" or faces.min() < 0 or faces.max() >= len(corners):
        raise InputError(f"`triangles` must hold indices of the {len(corners)} vertices, from 0 on.")
    return corners, faces.astype(np.int64)
