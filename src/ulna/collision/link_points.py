"""Points around the solids of a link, of which no point of the link is farther out in any direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from ulna.collision.solids import Solid, hull
from ulna.errors import InputError
from ulna.geometry import Capsule, Cylinder, Sphere
from ulna.spatial import SE3, Motion
from ulna.typing import Floats

_SIDES = 24  # of the prism around a cylinder
_GRID = 32  # cells along the longest edge of a mesh, in which one ball stands for many points
_COARSE = 8  # cells where only speeds are asked for
_MOST = 100  # points of a mesh that are taken as they are


@final
@dataclass(frozen=True, eq=False)
class LinkPoints:
    """Balls whose convex hull contains a solid, or a link.

    Attributes:
        centres: In the frame of the link's joint, shape (n, 3) [m].
        radii: Shape (n,) [m].
    """

    centres: Floats
    radii: Floats

    def speed(self, T: SE3, twist: Motion) -> Floats:
        """The greatest speed of a point that a joint moves.

        Args:
            T: Poses of the link in the joint's frame, shape (m,) [m].
            twist: The joint's twist for one unit of its position.

        Returns:
            Speeds, shape (m,) or () [m/rad], [1].
        """
        w = np.asarray(twist.angular, dtype=float)
        points = self.centres @ np.swapaxes(T.rotation, -1, -2) + T.translation[..., None, :]
        speeds = np.linalg.norm(twist.linear + np.cross(w, points), axis=-1)
        return (speeds + float(np.linalg.norm(w)) * self.radii).max(axis=-1)


def joined_points(parts: Sequence[LinkPoints]) -> LinkPoints:
    """The balls of several solids together."""
    return LinkPoints(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in ("centres", "radii"))
    )


def fewer_points(points: LinkPoints) -> LinkPoints:
    """A few balls that contain others: speeds are convex, so those of a few bound those of all points."""
    if len(points.radii) <= _MOST:
        return points
    return LinkPoints(*_thinned(points.centres, points.radii, _COARSE))


def solid_points(solid: Solid) -> LinkPoints:
    """Balls whose convex hull contains a solid.

    Args:
        solid: The solid.

    Returns:
        The balls, in the frame of the link's joint.
    """
    centres, radii = _in_shape(solid)
    return LinkPoints(solid.placement @ centres, radii)


def _in_shape(solid: Solid) -> tuple[Floats, Floats]:
    """Centres in the frame of a solid's shape, and radii."""
    shape = solid.shape
    if len(solid.vertices):
        try:
            corners, _ = hull(solid.vertices)
        except InputError:  # they lie in a plane
            corners = solid.vertices
        zeros = np.zeros(len(corners))
        return (corners, zeros) if len(corners) <= _MOST else _thinned(corners, zeros, _GRID)
    if isinstance(shape, Sphere):
        return np.zeros((1, 3)), np.array([shape.radius])
    if isinstance(shape, Capsule):
        ends = np.array([[0.0, 0.0, z * shape.length / 2.0] for z in (-1.0, 1.0)])
        return ends, np.full(2, shape.radius)
    if isinstance(shape, Cylinder):
        angle = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
        r, z = shape.radius / np.cos(np.pi / _SIDES), np.full(_SIDES, shape.length / 2.0)
        ring = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
        corners = np.concatenate([ring, ring * [1.0, 1.0, -1.0]])
    else:
        centre, half = solid.bounds
        corners = centre + half * np.array(np.meshgrid(*3 * [[-1.0, 1.0]])).reshape(3, -1).T
    return corners, np.zeros(len(corners))


def _thinned(points: Floats, radii: Floats, grid: int) -> tuple[Floats, Floats]:
    """Fewer balls that contain balls: one for each cell of a grid that holds the centre of any."""
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    edge = max(float(size.max()) / grid, 1e-9)
    cells, member = np.unique(np.floor((points - low) / edge).astype(int), axis=0, return_inverse=True)
    centres = low + (cells + 0.5) * edge
    apart = np.linalg.norm(points - centres[member.ravel()], axis=1) + radii
    largest = np.zeros(len(cells))
    np.maximum.at(largest, member.ravel(), apart)
    return centres, largest
