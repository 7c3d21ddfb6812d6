"""What coal is asked: two solids at their poses; the only file that imports it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from ulna.collision.solids import Solid, hull
from ulna.data_classes import dataclass
from ulna.errors import InputError, needed
from ulna.geometry import (
    Box,
    Capsule,
    Cone,
    Cylinder,
    Ellipsoid,
    HeightField,
    Mesh,
    Plane,
    PointCloud,
    Sphere,
)
from ulna.typing import Array, Floats

_NO_AREA = 1e-15  # twice the area up to which a triangle has none [m^2]
_WIDTH = 1e-8  # that such a triangle is given [m]


def coal() -> Any:
    """The coal package.

    Raises:
        MissingExtra: If it is not installed.
    """
    with needed("coal", "collision", "Exact collision checking"):
        import coal as package  # pyright: ignore[reportMissingImports]
    return package


def geometry_of(solid: Solid, convex: bool) -> Any:
    """The coal geometry of a solid.

    Args:
        solid: The solid.
        convex: Whether a mesh becomes its convex hull; else it stays its triangles.

    Returns:
        The geometry.

    Raises:
        InputError: coal has no such shape.
    """
    c = coal()
    match solid.shape:
        case Box(size=size):
            return c.Box(*size)
        case Sphere(radius=radius):
            return c.Sphere(radius)
        case Cylinder(radius=radius, length=length):
            return c.Cylinder(radius, length)
        case Capsule(radius=radius, length=length):
            return c.Capsule(radius, length)
        case Cone(radius=radius, length=length):
            return c.Cone(radius, length)
        case Ellipsoid(radii=radii):
            return c.Ellipsoid(*radii)
        case Plane():
            return c.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        case Mesh() if convex:
            return _convex(*hull(solid.vertices))
        case Mesh() | HeightField():
            return _triangles(solid.vertices, solid.triangles)
        case PointCloud():
            return _points(solid.vertices)
    raise InputError(f"{solid.shape.describe()} of {solid.owner!r} takes no part in collisions.")


def _convex(vertices: Floats, triangles: Array) -> Any:
    c = coal()
    points, faces = c.StdVec_Vec3s(), c.StdVec_Triangle()
    for vertex in vertices:
        points.append(vertex)
    for a, b, d in triangles.tolist():
        faces.append(c.Triangle(a, b, d))
    return c.Convex(points, faces)


def _points(vertices: Floats) -> Any:
    """Points as triangles of a micrometre: coal takes no points."""
    corners = vertices[:, None] + 1e-6 * (np.eye(3) - 1.0 / 3.0)
    return _triangles(corners.reshape(-1, 3), np.arange(3 * len(vertices)).reshape(-1, 3))


def _with_area(vertices: Floats, triangles: Array) -> tuple[Floats, Array]:
    """Triangles of which those without area are ten nanometres wide.

    coal 3.0 finds every sphere to touch a triangle without area, however far away it is.
    """
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat = np.flatnonzero(np.linalg.norm(normals, axis=1) <= _NO_AREA)
    if not len(flat):
        return vertices, triangles
    wider = corners[flat] + _WIDTH * (np.eye(3) - 1.0 / 3.0)
    triangles = np.array(triangles)
    triangles[flat] = len(vertices) + np.arange(3 * len(flat)).reshape(-1, 3)
    return np.concatenate([vertices, wider.reshape(-1, 3)]), triangles


def _triangles(vertices: Floats, triangles: Array) -> Any:
    vertices, triangles = _with_area(vertices, triangles)
    model = coal().BVHModelOBBRSS()
    model.beginModel(len(triangles), len(vertices))
    model.addVertices(np.asfortranarray(vertices))
    model.addTriangles(np.asfortranarray(triangles))
    model.endModel()
    return model


@dataclass(frozen=True)
class Poses:
    """Poses of every solid, and the boxes around them, for some configurations; links first, then obstacles."""

    rotation: Floats  # (rows, n, 3, 3)
    translation: Floats  # (rows, n, 3)
    centre: Floats  # (rows, n, 3)
    half: Floats  # (rows, n, 3)


@dataclass(frozen=True)
class NearestPoints:
    """A distance that coal found, by the numbers of the two solids."""

    distance: float
    points: Floats
    normal: Floats
    first: int
    second: int


@final
@dataclass(frozen=True)
class PosedSolids:
    """The solids of a checker at one configuration.

    Attributes:
        bounds: Lower bounds of signed distances, inf for pairs that are not checked, (n links, n) [m].
    """

    bounds: Floats
    _poses: Poses
    _narrow: Narrow

    def distance(self, i: int, j: int) -> float:
        """The signed distance of two solids.

        Args:
            i, j: Their numbers.

        Returns:
            The distance [m].
        """
        return self._narrow.distance(self._poses, 0, i, j).distance


class Narrow:
    """Coal's objects, reused from pair to pair; not for two threads at once.

    Args:
        geometries: The geometries, those that move with the robot first.
        margins: How far these must stay apart, by which their distances are less, shape (moving, all) [m].
    """

    def __init__(self, geometries: Sequence[Any], margins: Floats) -> None:
        c = coal()
        self._geometries = geometries
        self._margins = margins.tolist() if margins.any() else None
        self._transforms = [c.Transform3s() for _ in geometries]
        self._poses: Poses | None = None
        self._rows = [-1] * len(geometries)
        self._collisions: dict[tuple[int, int], Any] = {}
        self._distances: dict[tuple[int, int], Any] = {}
        self._request, self._result = c.DistanceRequest(), c.DistanceResult()

    def _place(self, poses: Poses, row: int, k: int) -> Any:
        if poses is not self._poses:
            self._poses, self._rows = poses, [-1] * len(self._geometries)
        if self._rows[k] != row:
            self._transforms[k].setTransform(poses.rotation[row, k], poses.translation[row, k])
            self._rows[k] = row
        return self._transforms[k]

    def collision(self, margin: float) -> Any:
        """A function that says whether two solids come as near as `margin`."""
        c = coal()
        request, result = c.CollisionRequest(), c.CollisionResult()
        request.security_margin, request.num_max_contacts = margin, 1
        margins = self._margins
        request.enable_contact = (
            True  # without it coal 3.0 calls some shapes free that share an axis and overlap
        )
        made, geometries, place = self._collisions, self._geometries, self._place

        def ask(poses: Poses, row: int, i: int, j: int) -> bool:
            pair = made.get((i, j))
            if pair is None:
                pair = made[i, j] = c.ComputeCollision(geometries[i], geometries[j])
            result.clear()
            if margins is not None:
                request.security_margin = margin + margins[i][j]
            return pair(place(poses, row, i), place(poses, row, j), request, result) > 0

        return ask

    def _asked(self, poses: Poses, row: int, i: int, j: int) -> float:
        """The distance that coal finds [m]; points and normal are in `_result`."""
        pair = self._distances.get((i, j))
        if pair is None:
            pair = self._distances[i, j] = coal().ComputeDistance(self._geometries[i], self._geometries[j])
        self._result.clear()
        return pair(self._place(poses, row, i), self._place(poses, row, j), self._request, self._result)

    def separation(self, poses: Poses, row: int, i: int, j: int) -> tuple[float, Any]:
        """The distance of two solids and its direction, for many questions.

        Args:
            poses: The poses of all solids.
            row: The configuration in the batch.
            i, j: The numbers of the two solids.

        Returns:
            The signed distance [m], and a unit vector from the first to the second, shape (3,).
        """
        return self._asked(poses, row, i, j), self._result.normal

    def distance(self, poses: Poses, row: int, i: int, j: int, best: NearestPoints | None = None) -> Any:
        """The distance of two solids.

        Args:
            poses: The poses of all solids.
            row: The configuration in the batch.
            i, j: The numbers of the two solids.
            best: What was nearest so far; None for nothing.

        Returns:
            The distance with its points and normal, or `best` where that is not larger.
        """
        d, result = self._asked(poses, row, i, j), self._result
        if self._margins is not None:
            d -= self._margins[i][j]
        if best is not None and best.distance <= d:
            return best
        points = np.stack([result.getNearestPoint1(), result.getNearestPoint2()])
        return NearestPoints(float(d), points, np.array(result.normal), i, j)
