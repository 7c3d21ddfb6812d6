"""Shapes as coal's collision geometries; the only file that imports coal."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.collision.solids import Solid, hull
from ulna.errors import InputError, MissingExtra
from ulna.geometry import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Plane, Sphere
from ulna.typing import Array, Floats


def coal() -> Any:
    """The coal package.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        import coal as package  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise MissingExtra("coal", "collision", "Exact collision checking") from error
    return package


def geometry_of(solid: Solid, convex: bool) -> Any:
    """The coal geometry of a solid; meshes as their triangles, or as their convex hull."""
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
        case Mesh():
            if convex:
                return _convex(*hull(solid.vertices))
            return _triangles(solid.vertices, solid.triangles)
    raise InputError(f"{solid.shape.describe()} of {solid.owner!r} takes no part in collisions.")


def _convex(vertices: Floats, triangles: Array) -> Any:
    c = coal()
    points, faces = c.StdVec_Vec3s(), c.StdVec_Triangle()
    for vertex in vertices:
        points.append(vertex)
    for a, b, d in triangles.tolist():
        faces.append(c.Triangle(a, b, d))
    return c.Convex(points, faces)


def _triangles(vertices: Floats, triangles: Array) -> Any:
    model = coal().BVHModelOBBRSS()
    model.beginModel(len(triangles), len(vertices))
    model.addVertices(np.asfortranarray(vertices))
    model.addTriangles(np.asfortranarray(triangles))
    model.endModel()
    return model
