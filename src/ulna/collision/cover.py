"""Points that stand for the inside of convex shapes: any point of the solid is near one of them.

| symbol | meaning | shape | unit |
|---|---|---|---|
| h | step of a grid | | [m] |
| delta | h sqrt(3) / 2: nothing is farther from the grid | | [m] |
| x | a point of a solid; the nearest point g of the grid has abs(x - g) <= delta | (3,) | [m] |
| P | projection onto a convex solid; abs(P(a) - P(b)) <= abs(a - b) | | |

Hence abs(x - P(g)) = abs(P(x) - P(g)) <= delta: the projected grid is as dense in the solid as the grid in space.
Source: Boyd and Vandenberghe, Convex Optimization (2004), section 8.1, on projections; the rest follows.
"""

from __future__ import annotations

import numpy as np

from ulna.collision.solids import Solid, half_spaces
from ulna.errors import InputError
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Shape, Sphere
from ulna.spatial import SE3
from ulna.typing import Array, Floats

_MOST = 60_000  # points of a grid


def sample(solid: Solid, place: SE3, step: float) -> tuple[Floats, Floats, float]:
    """Points no farther than `delta` from any point of a solid.

    Args:
        solid: A bounded solid, as its convex hull.
        place: T_common_shape [m]; the points are in the common frame.
        step: Step of the grid [m]; made wider where it would have too many points.

    Returns:
        The points, shape (n, 3) [m], those of them that lie inside, shape (k, 3) [m], and `delta` [m].

    Raises:
        InputError: If the solid is a plane.
    """
    centre, half = solid.bounds
    if not np.isfinite(half).all():
        raise InputError(
            f"The {solid.shape.describe()} of {solid.owner!r} is boundless; no spheres cover it."
        )
    h = max(step, float(np.prod(2 * half + 2 * step) / _MOST) ** (1 / 3))
    reach = h * float(np.sqrt(3) / 2)
    counts = np.ceil(half / h).astype(int) + 1
    axes = [middle + h * np.arange(-n, n + 1) for middle, n in zip(centre, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    near, inside = _onto(solid, grid, reach)
    return place @ near, place @ inside, reach


def _onto(solid: Solid, grid: Floats, reach: float) -> tuple[Floats, Floats]:
    """What of a grid stands for a solid, and what of that lies inside."""
    nearest = _projection(solid.shape, grid)
    if nearest is not None:
        nearby = nearest[((nearest - grid) ** 2).sum(axis=1) <= reach**2]
        return nearby, nearby
    beyond = _beyond(solid, grid)
    return grid[beyond <= reach], np.vstack([grid[beyond <= 0.0], solid.vertices])


def _beyond(solid: Solid, points: Floats) -> Floats:
    """Lower bounds of the distances of points from a solid without a formula for them; not above 0 inside."""
    match solid.shape:
        case Ellipsoid(radii=radii):  # the gauge of an ellipsoid grows by at most 1 / (least half axis)
            return (np.sqrt(((points / np.array(radii)) ** 2).sum(axis=1)) - 1.0) * min(radii)
        case Cone(radius=r, length=length):
            rho, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
            slope = (rho * length + r * (z - length / 2.0)) / np.hypot(r, length)
            return np.maximum(slope, -length / 2.0 - z)
    beyond = np.full(len(points), -np.inf)
    for normal, offset in zip(*half_spaces(solid), strict=True):
        np.maximum(beyond, points @ normal - offset, out=beyond)
    return beyond


def _projection(shape: Shape, points: Floats) -> Array | None:
    """The points of a shape nearest to `points`; None where there is no formula for it."""
    match shape:
        case Box(size=size):
            half = np.array(size) / 2.0
            return np.clip(points, -half, half)
        case Sphere(radius=radius):
            return _within(points, radius)
        case Capsule(radius=radius, length=length):
            axis = np.zeros_like(points)
            axis[:, 2] = np.clip(points[:, 2], -length / 2.0, length / 2.0)
            return axis + _within(points - axis, radius)
        case Cylinder(radius=radius, length=length):
            z = np.clip(points[:, 2:], -length / 2.0, length / 2.0)
            return np.hstack([_within(points[:, :2], radius), z])
    return None


def _within(points: Floats, radius: float) -> Floats:
    """Points drawn back along their rays to at most `radius` from the origin."""
    length = np.sqrt((points**2).sum(axis=1, keepdims=True))
    return points * np.minimum(1.0, radius / np.maximum(length, radius * 1e-12))
