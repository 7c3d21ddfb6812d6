"""Mesh decimation with an error bound: edges collapse while the surface stays within a distance of the original.

Edges collapse in the order of Garland & Heckbert, "Surface simplification using quadric error metrics" (1997). How far
the surface moved is then measured, and edges are given back until it is within the bound.

| symbol | meaning | shape, unit |
|---|---|---|
| vertices, triangles | the surface | (n, 3) [m]; (m, 3) |
| bound | how far any vertex may be from the new surface | [m] |
| moved | where each vertex went: a vertex of the new surface | (n,) |
"""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np

from ulna.system import forks
from ulna.typing import Array, Floats

_MIN_TRIANGLES = 200  # triangles that are not worth the trouble
_MAX_TRIANGLES = 300_000  # triangles that take longer to collapse than anybody waits
_QUADRIC_LIMIT = 1e-9  # the library's limit of a quadric error, which the surface is scaled to
_SAFETY_FACTOR = (
    2.0  # a quadric adds distances from many planes, and so is twice what the surface moves, or more
)
_MAX_ATTEMPTS = 6
_library_lock = forks.lock()  # the library keeps the surface in one place


def can_decimate() -> bool:
    """Whether the package fast-simplification is installed."""
    return importlib.util.find_spec("fast_simplification") is not None


def decimated(vertices: Floats, triangles: Array, bound: float) -> tuple[Floats, Array]:
    """A surface with fewer triangles, from which no vertex of the old one is farther than `bound`.

    Open edges, where surfaces of other colours begin, stay as they are. Without the package fast-simplification, and
    for small and for very large surfaces, it is the surface itself.

    Args:
        vertices: Positions, shape (n, 3); each once, so that triangles share them.
        triangles: Indices of vertices, shape (m, 3), none of them without area.
        bound: The distance, in units of `vertices` [any].

    Returns:
        Positions (k, 3) and triangles (l, 3) of the new surface; unused positions may be among them.
    """
    if not _MIN_TRIANGLES <= len(triangles) <= _MAX_TRIANGLES or not can_decimate():
        return vertices, triangles
    import fast_simplification as library

    unchanged = np.zeros(len(triangles), dtype=bool)  # as they are, because edges around them went too far
    for _ in range(_MAX_ATTEMPTS):
        some, inside = np.unique(triangles[~unchanged], return_inverse=True)
        if not len(some):
            break
        old = vertices[some]
        points, faces, moved = _collapsed(library, old, inside.reshape(-1, 3), bound)
        far = distances(old, points, faces, moved, bound) > bound
        if not far.any():
            unchanged_triangles = triangles[unchanged]
            return np.concatenate([points, vertices]), np.concatenate(
                [faces, unchanged_triangles + len(points)]
            )
        lost = np.zeros(len(vertices), dtype=bool)
        lost[some[far]] = True
        lost[triangles[lost[triangles].any(axis=1)]] = True
        unchanged |= lost[triangles].any(axis=1)
    return vertices, triangles


def _collapsed(library: Any, vertices: Floats, triangles: Array, bound: float) -> tuple[Floats, Array, Array]:
    """Vertices and triangles after edges collapsed, and where each vertex went."""
    scale, middle = np.sqrt(_QUADRIC_LIMIT) / (_SAFETY_FACTOR * bound), vertices.mean(axis=0)
    surface = (vertices - middle) * scale, triangles.astype(np.int32)
    with _library_lock:
        # a constant limit: the exponent by which it would grow is 0, and so few triangles are never reached
        points, faces, collapses = library.simplify(
            *surface, target_count=4, agg=0.0, return_collapses=True, preserve_border=True
        )
        *_, moved = library.replay_simplification(*surface, collapses)  # its points are less precise
    return (
        np.asarray(points, dtype=float) / scale + middle,
        np.asarray(faces, dtype=np.int64),
        np.asarray(moved),
    )


def distances(points: Floats, vertices: Floats, triangles: Array, near: Array, enough: float = 0.0) -> Floats:
    """Upper bounds of the distances of points from a surface: a walk over it, downhill from a vertex near each
    point.

    Args:
        points: The points, (k, 3).
        vertices: Vertices of the surface, (n, 3).
        triangles: Indices of vertices, (m, 3).
        near: A vertex near each point, (k,).
        enough: Distance within which a point walks no further [any].

    Returns:
        The bounds, (k,).
    """
    corners = triangles.reshape(-1)
    ring = np.argsort(corners, kind="stable") // 3  # triangles in the order of their vertices
    count = np.bincount(corners, minlength=len(vertices))
    first = np.cumsum(count) - count
    best = np.full(len(points), np.inf)
    point_index, vertex = np.arange(len(points)), near
    while len(point_index):
        each = count[vertex]
        row = np.repeat(np.arange(len(vertex)), each)
        face = ring[first[vertex][row] + np.arange(len(row)) - np.repeat(np.cumsum(each) - each, each)]
        apart = _point_triangle(points[point_index[row]], vertices[triangles[face]])
        order = np.lexsort((apart, point_index[row]))
        points_reached, first_index = np.unique(point_index[row][order], return_index=True)
        nearest = order[first_index]
        better = apart[nearest] < best[points_reached] * (1 - 1e-9)
        best[points_reached[better]] = apart[nearest[better]]
        better &= best[points_reached] > enough
        point_index = np.repeat(points_reached[better], 3)  # go on from the corners of the nearest triangle
        vertex = triangles[face[nearest[better]]].reshape(-1)
    return best


def _point_triangle(points: Floats, corners: Floats) -> Floats:
    """Distances of points (k, 3) from triangles (k, 3, 3): from the plane where above it, else from edges."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.einsum("ij,ij->i", normal, normal)
    inside = area > 0.0
    squared = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        edge, away = end - start, points - start
        length = np.einsum("ij,ij->i", edge, edge)
        share = np.clip(np.einsum("ij,ij->i", away, edge) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        offset = away - share[:, None] * edge
        squared = np.minimum(squared, np.einsum("ij,ij->i", offset, offset))
        inside &= np.einsum("ij,ij->i", np.cross(edge, away), normal) >= 0.0
    height = np.einsum("ij,ij->i", points - a, normal) ** 2 / np.where(area > 0.0, area, 1.0)
    return np.sqrt(np.where(inside, np.minimum(height, squared), squared))
