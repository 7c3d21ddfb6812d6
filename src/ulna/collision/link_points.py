"""Points around the solids of a link, of which no point of the link is farther out in any direction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from ulna.collision.solids import Solid, hull
from ulna.compiler.procedures import Array1, Array2, broadcast, f64, least_of, procedure
from ulna.errors import InputError
from ulna.geometry import Capsule, Cylinder, Plane, Sphere
from ulna.spatial import SE3, Motion
from ulna.typing import Floats

_SIDES = 24  # of the prism around a cylinder
_GRID = 64  # cells along the longest edge of a mesh, in which one ball stands for many points
_COARSE = 8  # cells where only speeds are asked for
_MOST = 2000  # points of a mesh that are taken as they are
_FEW = 100  # where only speeds are asked for
_ENDLESS = 1e30  # radius of the ball in place of a half-space [m]; with inf a joint that does not turn would yield nan


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


@final
class LinkSpeeds:
    """The greatest speeds of points of a link.

    Args:
        points: Balls whose convex hull contains the link; speeds are convex, so those of the balls bound all.
    """

    def __init__(self, points: LinkPoints) -> None:
        count = len(points.radii)
        self._columns = np.zeros((4, -(-count // _LANES) * _LANES))
        self._columns[:3, :count], self._columns[3, :count] = points.centres.T, points.radii
        self._columns[:, count:] = self._columns[:, :1]

    def of(self, X: SE3, twist: Motion, count: int) -> Floats:
        """The greatest speed of a point that a joint moves.

        Args:
            X: Poses of the link in the joint's frame, shape (count,) or () [m].
            twist: The joint's twist for one unit of its position.
            count: How many poses there are.

        Returns:
            Speeds, shape (count,) [m/rad], [1].
        """
        w, v = (np.asarray(part, dtype=float) for part in (twist.angular, twist.linear))
        poses = np.empty((count, 12))
        poses[:, :9], poses[:, 9:] = X.rotation.reshape(-1, 9), X.translation
        out = np.empty(count)
        if count:
            _speeds(self._columns, poses, np.concatenate([w, v, [np.linalg.norm(w)]]), out)
        return out


@procedure(constants={"W": 8})
def _speeds_in_lanes(
    columns: Array2[f64], poses: Array2[f64], twist: Array1[f64], out: Array1[f64], W: int
) -> None:
    """Writes the greatest of norm(v + w x (R c + t)) + norm(w) r over balls.

    Args:
        columns: Coordinates and radii of the balls, filled up to whole registers, (4, balls) [m].
        poses: R by rows, and t, (n, 12) [m].
        twist: w, v and norm(w), (7,).
        out: Receives the speeds, (n,).
        W: Lanes, a constant.
    """
    for row in range(len(out)):
        most = broadcast(f64(0.0), W)
        for i in range(0, columns.shape[1], W):
            x, y, z = columns[0, i : i + W], columns[1, i : i + W], columns[2, i : i + W]
            a = poses[row, 0] * x + poses[row, 1] * y + poses[row, 2] * z + poses[row, 9]
            b = poses[row, 3] * x + poses[row, 4] * y + poses[row, 5] * z + poses[row, 10]
            c = poses[row, 6] * x + poses[row, 7] * y + poses[row, 8] * z + poses[row, 11]
            u = twist[3] + twist[1] * c - twist[2] * b
            v = twist[4] + twist[2] * a - twist[0] * c
            w = twist[5] + twist[0] * b - twist[1] * a
            most = np.maximum(most, np.sqrt(u * u + v * v + w * w) + twist[6] * columns[3, i : i + W])
        out[row] = -least_of(-most)


_LANES = 8
_speeds = _speeds_in_lanes.specialized(W=_LANES)


def joined_points(parts: Sequence[LinkPoints]) -> LinkPoints:
    """The balls of several solids together."""
    return LinkPoints(
        *(np.concatenate([getattr(part, name) for part in parts]) for name in ("centres", "radii"))
    )


def fewer_points(points: LinkPoints) -> LinkPoints:
    """A few balls that contain others: speeds are convex, so those of a few bound those of all points."""
    if len(points.radii) <= _FEW:
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
        radii = np.full(len(corners), solid.rounding)
        return (corners, radii) if len(corners) <= _MOST else _thinned(corners, radii, _GRID)
    if isinstance(shape, Plane):
        return np.zeros((1, 3)), np.array([_ENDLESS])
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
