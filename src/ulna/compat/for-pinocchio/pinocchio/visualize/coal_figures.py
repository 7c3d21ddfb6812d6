"""Objects of coal as triangles, boxes and points."""

from __future__ import annotations

from typing import Any

import numpy as np

from ulna.errors import InputError
from ulna.geometry import Box
from ulna.typing import Array, Floats
from ulna.viewer.colours import RGBA
from ulna.viewer.graph.content import Content, Copies, Points, transforms
from ulna.viewer.mesh.primitives import tessellate

PLANE_SIZE = 10.0
"""Edge of the square that is drawn for an infinite plane [m]."""
_POINT_SIZE = 0.01  # diameter [m]


def content_of(geometry: Any, rgba: RGBA) -> Content | None:
    """A point cloud or an octree as points or boxes; None for anything else.

    Args:
        geometry: An object of coal.
        rgba: Its colour.

    Returns:
        The content of a node.
    """
    kind = type(geometry).__name__
    if kind.startswith("BVHModel") and geometry.num_tris == 0:
        return Points(vertices_of(geometry), rgba[:3], _POINT_SIZE)
    if kind == "OcTree":
        boxes = np.array([np.asarray(box)[:4] for box in geometry.toBoxes()], dtype=float).reshape(-1, 4)
        cube = tessellate(Box((1.0, 1.0, 1.0)), rgba)
        return Copies((cube,), transforms(boxes[:, :3]), scales=np.repeat(boxes[:, 3:], 3, axis=1))
    return None


def vertices_of(geometry: Any) -> Floats:
    """The vertices of a mesh of coal, (n, 3) [m]."""
    return np.array(geometry.vertices(), dtype=float).reshape(-1, 3)


def _with_triangles(hull: Any) -> Any:
    """The convex hull of a hull that was made without triangles."""
    from ulna.collision.narrow import coal

    points = coal().StdVec_Vec3s()
    points.extend(list(hull.points()))
    return coal().Convex.convexHull(points, True, "")


def triangles_of(geometry: Any) -> tuple[Floats, Array]:
    """Vertices (n, 3) [m] and triangles (m, 3) of an object of coal.

    Args:
        geometry: A mesh, a convex hull, a height field, a triangle, a plane or a half space.

    Returns:
        Vertices and triangles.

    Raises:
        InputError: Anything else.
    """
    kind = type(geometry).__name__
    if kind.startswith("BVHModel"):
        faces = (geometry.tri_indices(i) for i in range(geometry.num_tris))
        return vertices_of(geometry), np.array([[int(t[k]) for k in range(3)] for t in faces])
    if kind.startswith("Convex"):
        geometry = geometry if hasattr(geometry, "num_polygons") else _with_triangles(geometry)
        faces = (geometry.polygons(i) for i in range(geometry.num_polygons))
        return np.array(geometry.points(), dtype=float), np.array(
            [[int(t[k]) for k in range(3)] for t in faces]
        )
    if kind.startswith("HeightField"):
        return _height_field(geometry)
    if kind == "TriangleP":
        corners = np.array([geometry.a, geometry.b, geometry.c], dtype=float)
        return corners, np.array([[0, 1, 2], [2, 1, 0]])
    if kind in ("Plane", "Halfspace"):
        return _plane(np.asarray(geometry.n, dtype=float), float(geometry.d))
    raise InputError(
        f"A {kind} cannot be drawn; expected a shape, a mesh, a height field, an octree or a plane."
    )


def _height_field(field: Any) -> tuple[Floats, Array]:
    """The solid between the lowest height and the heights over a grid."""
    x, y = np.meshgrid(field.getXGrid(), field.getYGrid())
    rows, columns = x.shape
    heights = np.asarray(field.getHeights(), dtype=float)
    bottom = np.full_like(heights, field.getMinHeight())
    vertices = np.stack([np.stack([x, y, z], axis=-1).reshape(-1, 3) for z in (heights, bottom)]).reshape(
        -1, 3
    )
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]  # y falls with the rows
    top = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, c, d), (a, d, b))])
    border = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    after, below = np.roll(border, -1), len(vertices) // 2
    sides = [(border, after, below + after), (border, below + after, below + border)]
    return vertices, np.concatenate([top, below + top[:, ::-1], *(np.stack(t, axis=1) for t in sides)])


def _plane(normal: Floats, offset: float) -> tuple[Floats, Array]:
    """A square around the point of a plane `normal . x = offset` that is nearest to the origin."""
    length = np.linalg.norm(normal)
    n = normal / length
    helper = np.eye(3)[int(np.argmin(np.abs(n)))]
    u: Floats = np.cross(n, helper).astype(float)
    u /= np.linalg.norm(u)
    v: Floats = np.cross(n, u).astype(float)
    half = PLANE_SIZE / 2
    corners = [offset / length * n + half * (i * u + j * v) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array(corners, dtype=float), np.array([[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]])
