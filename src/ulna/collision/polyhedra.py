"""Triangles around solids: a mesh's own, or those of a polyhedron that contains a shape with a formula.

| symbol | meaning | unit |
|---|---|---|
| n | sides of the regular polygon around a circle | |
| m | edges of the polyline around a quarter of a circle | |
| rho, z | distance from the axis of revolution, and height | [m] |

A regular polygon with n sides whose inscribed circle has radius r has corners at r / cos(pi / n): with n = 32 they are
0.5 % outside, so that what covers the polyhedron covers the shape, and hardly more.
"""

from __future__ import annotations

import numpy as np

from ulna.collision.solids import Solid
from ulna.errors import InputError
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere
from ulna.typing import Array, Floats

_SIDES = 32
_INNER = 1e-6  # [m]
_ARC = 8  # edges around a quarter of a circle, as fine as _SIDES


def triangles(solid: Solid) -> Floats:
    """The triangles of a mesh, or of a polyhedron that contains another shape.

    Args:
        solid: A bounded solid.

    Returns:
        Corners in the shape's frame, shape (n, 3, 3) [m].

    Raises:
        InputError: If the solid is a plane, or a mesh without triangles.
    """
    if isinstance(solid.shape, Mesh):
        if not len(solid.triangles):
            raise InputError(
                f"The mesh {solid.shape.path} of {solid.owner!r} has no triangles; no spheres cover it."
            )
        return solid.vertices[solid.triangles]
    corners_found = _polyhedron(solid.shape)
    if corners_found is None:
        raise InputError(
            f"The {solid.shape.describe()} of {solid.owner!r} is boundless; no spheres cover it."
        )
    return corners_found


def _polyhedron(shape: Shape) -> Floats | None:
    match shape:
        case Box(size=size):
            return _box(np.array(size))
        case Cylinder(radius=r, length=length):
            half = length / 2.0
            return _revolved(np.array([[0.0, -half], [r, -half], [r, half], [0.0, half]]))
        case Cone(radius=r, length=length):
            return _revolved(np.array([[0.0, -length / 2.0], [r, -length / 2.0], [0.0, length / 2.0]]))
        case Capsule(radius=r, length=length):
            return _revolved(_capped(r, length / 2.0))
        case Sphere(radius=r):
            return _revolved(_capped(r, 0.0))
        case Ellipsoid(radii=radii):
            return _revolved(_capped(1.0, 0.0)) * np.array(radii)
    return None


def _box(size: Floats) -> Floats:
    axis = np.array([-0.5, 0.5])
    corners = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(8, 3) * size
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners[[(a, *two) for a, b, c, d in faces for two in ((b, c), (c, d))]]


def _capped(r: float, half: float) -> Floats:
    """The outline of a capsule from top to bottom, as (rho, z), none of it inside."""
    angle = (np.arange(_ARC) + 0.5) * np.pi / (2.0 * _ARC)
    R = r / np.cos(np.pi / (4.0 * _ARC))
    top = np.stack([R * np.sin(angle), R * np.cos(angle) + half], axis=1)
    top = np.vstack([[0.0, top[0, 1]], top])
    return np.vstack([top, (top * [1.0, -1.0])[::-1]])


def _revolved(outline: Floats) -> Floats:
    """The triangles of an outline of (rho, z) turned about z, with polygons around the circles."""
    angle = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1) / np.cos(np.pi / _SIDES)
    rings = np.concatenate(
        [
            outline[:, None, :1] * ring,
            np.broadcast_to(outline[:, None, 1:], (len(outline), _SIDES, 1)),
        ],
        axis=2,
    )
    low, high = rings[:-1], rings[1:]
    low_next, high_next = np.roll(low, -1, axis=1), np.roll(high, -1, axis=1)
    pairs = [np.stack([low, low_next, high_next], axis=2), np.stack([low, high_next, high], axis=2)]
    corners_found = np.concatenate(pairs).reshape(-1, 3, 3)
    return corners_found[_areas(corners_found) > 0.0]


def _areas(corners: Floats) -> Array:
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def interior(shape: Shape, x: Floats) -> Array:
    """Which points are inside a convex shape that has a formula, by more than 1 um; none for balls and meshes.

    Args:
        shape: The shape.
        x: Points in its frame, shape (..., 3) [m].

    Returns:
        Truth values, shape (...).
    """
    rho, z = np.hypot(x[..., 0], x[..., 1]), x[..., 2]
    match shape:
        case Box(size=size):
            return np.asarray((np.abs(x) < np.array(size) / 2.0 - _INNER).all(axis=-1))
        case Cylinder(radius=r, length=length):
            return (rho < r - _INNER) & (np.abs(z) < length / 2.0 - _INNER)
        case Capsule(radius=r, length=length):
            return np.hypot(rho, np.maximum(np.abs(z) - length / 2.0, 0.0)) < r - _INNER
        case Cone(radius=r, length=length):
            slope = (rho * length + r * (z - length / 2.0)) / np.hypot(r, length)
            return (slope < -_INNER) & (z > _INNER - length / 2.0)
        case Ellipsoid(radii=radii):  # the gauge grows by at most 1 / (least half axis)
            return ((x / np.array(radii)) ** 2).sum(axis=-1) < (1.0 - _INNER / min(radii)) ** 2
    return np.zeros(x.shape[:-1], dtype=bool)


def split(corners: Floats, longest: float) -> Floats:
    """The same surface as triangles without long edges, by cutting the longest edge in half until all are short.

    Source: Rivara, Algorithms for refining triangular grids, International Journal for Numerical Methods in
    Engineering 20 (1984).

    Args:
        corners: Triangles, shape (n, 3, 3) [m].
        longest: No edge is longer [m].

    Returns:
        Triangles, shape (m, 3, 3) [m].
    """
    done = []
    while len(corners):
        edges = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)
        long = edges.max(axis=1) > longest
        done.append(corners[~long])
        corners, opposite = corners[long], edges[long].argmax(axis=1)
        row = np.arange(len(corners))
        a, b, c = (corners[row, (opposite + k) % 3] for k in range(3))
        middle = (b + c) / 2.0
        corners = np.concatenate([np.stack([a, b, middle], axis=1), np.stack([a, middle, c], axis=1)])
    return np.concatenate(done) if done else corners


def distance(p: Floats, corners: Floats) -> float:
    """How far a point is from the nearest of some triangles.

    Source: Ericson, Real-Time Collision Detection (2005), section 5.1.5: the nearest point is in the face, or on an
    edge.

    Args:
        p: Shape (3,) [m].
        corners: Triangles, shape (n, 3, 3) [m].

    Returns:
        The distance [m].
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = (normal**2).sum(axis=1)
    best, over = np.full(len(corners), np.inf), size > 0.0
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        edge, off = b - a, p - a
        length = (edge**2).sum(axis=1)
        along = np.clip((off * edge).sum(axis=1) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        best = np.minimum(best, ((off - along[:, None] * edge) ** 2).sum(axis=1))
        over &= (np.cross(edge, off) * normal).sum(axis=1) >= 0.0
    height = ((p - corners[:, 0]) * normal).sum(axis=1)
    return float(np.sqrt(np.where(over, height**2 / np.where(size > 0.0, size, 1.0), best).min()))
