"""Vertex normals with sharp edges: triangles share a vertex where the surface is smooth."""

from __future__ import annotations

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.mesh.decimation import decimated
from ulna.viewer.mesh.surface import DEFAULT_COLOUR, RGBA, Surface, Texture, normalized

CREASE = np.deg2rad(38.0)
"""Edges that turn by more than this [rad] are drawn sharp."""


def surface_with_normals(
    vertices: Floats,
    triangles: Array,
    rgba: RGBA = DEFAULT_COLOUR,
    crease: float = CREASE,
    uv: Floats | None = None,
    image: bytes = b"",
    bound: float = 0.0,
) -> Surface:
    """Loose triangles as a surface whose vertices are shared exactly where it is smooth.

    Two triangles share a vertex when they meet at an edge that turns by less than `crease` [rad]; the normal
    of a vertex is the mean of its triangles' normals weighted by area, which is also what a browser computes
    from the shared indices. Triangles without area are dropped. With places `uv` (n, 2) in an `image`, vertices that
    lie at two places of it occur twice. Without, edges collapse as long as no vertex is farther than `bound` from what
    is left.

    Args:
        vertices: Corners of the triangles, (n, 3) [m]; they may repeat.
        triangles: Indices of corners, (m, 3).
        rgba: The colour.
        crease: Smallest angle between normals at a sharp edge [rad].
        uv: Places in the image, (n, 2) from 0 to 1; None without a texture.
        image: Content of a PNG or JPEG file.
        bound: How far decimation may move the surface [m]; 0 for no decimation.

    Returns:
        The surface.
    """
    positions, index = merged_vertices(np.asarray(vertices, dtype=float))
    uv_triangles = np.asarray(triangles, dtype=np.int64)
    corners = index[uv_triangles]
    solid = np.linalg.norm(_area_normals(positions, corners), axis=1) > 1e-16
    corners, uv_triangles = corners[solid], uv_triangles[solid]
    if uv is None and bound > 0.0:
        positions, corners = decimated(positions, corners, bound)
    weighted = _area_normals(positions, corners)
    facing = normalized(weighted)
    first, vertex = _shared_vertices(corners, weighted, facing, crease, len(positions))
    normals = np.zeros((len(first), 3))
    per_corner = np.repeat(weighted, 3, axis=0)
    for axis in range(3):
        normals[:, axis] = np.bincount(vertex, weights=per_corner[:, axis], minlength=len(first))
    if uv is None:
        return Surface(
            positions[corners.reshape(-1)[first]], vertex.reshape(-1, 3), normalized(normals), rgba
        )
    uv_positions, uv_index = np.unique(np.round(uv, 6), axis=0, return_inverse=True)
    pair = vertex * len(uv_positions) + uv_index.reshape(-1)[uv_triangles.reshape(-1)]
    both, split = np.unique(pair, return_inverse=True)
    owner = both // len(uv_positions)
    texture = Texture(uv_positions[both % len(uv_positions)], image)
    return Surface(
        positions[corners.reshape(-1)[first[owner]]],
        split.reshape(-1, 3),
        normalized(normals)[owner],
        rgba,
        texture,
    )


def _area_normals(vertices: Floats, triangles: Array) -> Floats:
    """Normals as long as twice the area of triangles, shape (m, 3)."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def merged_vertices(vertices: Floats) -> tuple[Floats, Array]:
    """Vertices that lie together become one: the distinct positions, and each vertex's index among them."""
    if not len(vertices):
        return vertices, np.zeros(0, dtype=np.int64)
    low = vertices.min(axis=0)
    extent = float((vertices.max(axis=0) - low).max()) or 1.0
    cell = np.round((vertices - low) * ((2**20) / extent)).astype(np.int64)
    key = (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]
    _, first, index = np.unique(key, return_index=True, return_inverse=True)
    return vertices[first], index.reshape(-1)


def _shared_vertices(
    corners: Array, weighted: Floats, facing: Floats, crease: float, count: int
) -> tuple[Array, Array]:
    """Which corners (3 m) share a vertex: the first corner of each vertex, and the vertex of each corner.

    Where all triangles around a place face within half a crease of their mean they share it; only around other places
    are edges looked at.
    """
    flat = corners.reshape(-1)
    mean = np.stack(
        [np.bincount(flat, np.repeat(column, 3), minlength=count) for column in weighted.T], axis=1
    )
    turned = np.einsum("ij,ikj->ik", facing, normalized(mean)[corners]) <= np.cos(crease / 2)
    sharp = np.bincount(flat[turned.reshape(-1)], minlength=count) > 0
    label = flat.copy()
    near = np.flatnonzero(sharp[corners].any(axis=1))
    sharp_corners = 3 * near[:, None] + np.arange(3)
    joined = sharp_corners.reshape(-1)[_corner_labels(corners[near], facing[near], crease, count)].reshape(
        -1, 3
    )
    label[sharp_corners] = np.where(sharp[corners[near]], joined + count, label[sharp_corners])
    first_corner = np.full(count + len(flat), len(flat), dtype=np.int64)
    np.minimum.at(first_corner, label, np.arange(len(flat)))
    used = np.flatnonzero(first_corner < len(flat))
    number = np.empty(len(first_corner), dtype=np.int64)
    number[used] = np.arange(len(used))
    return first_corner[used], number[label]


def _corner_labels(corners: Array, facing: Floats, crease: float, count: int) -> Array:
    """A label for every corner (3 m); corners with one label share a vertex."""
    m = len(corners)
    face = np.tile(np.arange(m), 3)
    start = np.concatenate([corners[:, 0], corners[:, 1], corners[:, 2]])
    end = np.concatenate([corners[:, 1], corners[:, 2], corners[:, 0]])
    side = np.repeat(np.arange(3), m)
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.argsort(low * count + high, kind="stable")
    low, high, face, side, start = low[order], high[order], face[order], side[order], start[order]
    # neighbours in this order that have the same two ends are two triangles at one edge
    same = (low[1:] == low[:-1]) & (high[1:] == high[:-1])
    one, two = np.flatnonzero(same), np.flatnonzero(same) + 1
    smooth_edge = np.einsum("ij,ij->i", facing[face[one]], facing[face[two]]) > np.cos(crease)
    one, two = one[smooth_edge], two[smooth_edge]
    first_one, second_one = face[one] * 3 + side[one], face[one] * 3 + (side[one] + 1) % 3
    first_two, second_two = face[two] * 3 + side[two], face[two] * 3 + (side[two] + 1) % 3
    turned = start[one] != start[two]  # the usual case: the edge runs the other way in the neighbour
    links = np.concatenate(
        [
            np.stack([first_one, np.where(turned, second_two, first_two)]),
            np.stack([second_one, np.where(turned, first_two, second_two)]),
        ],
        axis=1,
    )
    label = np.arange(3 * m)
    while True:
        low_label = np.minimum(label[links[0]], label[links[1]])
        new = label.copy()
        np.minimum.at(new, label[links[0]], low_label)
        np.minimum.at(new, label[links[1]], low_label)
        new = new[new]
        if np.array_equal(new, label):
            return label
        label = new
