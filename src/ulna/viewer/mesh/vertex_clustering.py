"""Fast simplification by vertex clustering, for pages without a graphics card while things move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ulna.typing import Floats
from ulna.viewer.mesh.surface import Surface, normalized

CLUSTERING_THRESHOLD = 100_000
"""Triangles from which on a surface is drawn in few of them while things move."""
_CELLS = 20_000  # of cubes that a surface of their area would fill
_SAMPLE = 16  # one triangle in so many is used to estimate the area


def clustered(surface: Surface) -> Surface:
    """The surface with vertices in one cube of a grid, that face alike, moved to their mean: some 50,000 triangles."""
    vertices, triangles = surface.vertices, surface.triangles
    a, b, c = (vertices[triangles[::_SAMPLE, k]] for k in range(3))
    area = _SAMPLE * 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
    low = vertices.min(axis=0)
    size = max(np.sqrt(area / _CELLS), float((vertices.max(axis=0) - low).max()) / 2**19, 1e-300)
    x, y, z = ((vertices - low) / size).astype(np.int64).T
    facing = (
        np.rint(surface.normals).astype(np.int64) @ (1, 3, 9) + 13
    )  # both sides of a thin sheet stay apart
    key = (((x << 19 | y) << 19) | z) << 5 | facing
    _, which, count = np.unique(key, return_inverse=True, return_counts=True)

    def mean(values: Floats) -> Floats:
        return np.stack([np.bincount(which, weights=column) / count for column in values.T], axis=1)

    corners = which[triangles]
    apart = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    return replace(
        surface,
        vertices=mean(vertices),
        triangles=corners[apart],
        normals=normalized(mean(surface.normals)),
    )
