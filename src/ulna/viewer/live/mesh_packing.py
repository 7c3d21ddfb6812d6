"""Surfaces packed for a page: positions on a grid, triangles as a walk, both compressed.

| symbol | meaning | unit |
|---|---|---|
| step | width of the grid that positions are rounded to | [m] |
| residual | position minus its prediction by the walk, in steps | (n, 3) |

Normals are not stored: the page computes them from positions, as `mesh/vertex_normals.py` does.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from ulna.typing import Array, Floats
from ulna.viewer.live.triangle_codes import walk
from ulna.viewer.mesh.decimation import decimated
from ulna.viewer.mesh.surface import RGBA, Surface
from ulna.viewer.mesh.vertex_normals import merged_vertices

_STEPS = 1 << 15  # steps along an edge of a link, at most: residuals then fit into two bytes
_BOUNDS = ((3e-4,), (3e-4,) * 2, (6e-4,) * 2, (1.2e-3,) * 2, (4e-3,) * 2)
"""Levels: how far the surface may move in each round of simplification [m]."""

_RELATIVE_BOUND = 2e-3  # of the size of a surface


@final
@dataclass(frozen=True)
class PackedMeshes:
    """The surfaces of a robot.

    Args:
        data: The compressed streams, in the order codes, names, low bytes, high bytes.
        surfaces: For each surface its link, colour and numbers of triangles, codes, names and vertices.
        streams: Lengths of the streams before compression [bytes].
        step: Width of the grid [m].
    """

    data: bytes
    surfaces: tuple[dict[str, Any], ...]
    streams: tuple[int, ...]
    step: float

    @property
    def triangles(self) -> int:
        """How many triangles there are."""
        return sum(s["triangles"] for s in self.surfaces)


def packed_within(links: Sequence[Iterable[Surface]], size: int, step: float) -> PackedMeshes:
    """The surfaces of each link, simplified as little as needed for them to have at most `size` bytes.

    Args:
        links: The surfaces by link.
        size: The size to reach [bytes]; where none of the levels reaches it, the smallest is returned.
        step: Width of the grid [m].

    Returns:
        The packed surfaces.
    """
    merged = [[_merged(surface) for surface in link] for link in links]
    tried: list[PackedMeshes] = []
    for bounds in _BOUNDS:
        tried.append(
            pack([[(s[0], *_simplified(s[1], s[2], bounds)) for s in link] for link in merged], step)
        )
        if len(tried[-1].data) <= size:
            break
    return min(tried, key=lambda packed: len(packed.data))


def pack(links: Sequence[Sequence[tuple[RGBA, Floats, Array]]], step: float) -> PackedMeshes:
    """Surfaces packed as they are.

    Args:
        links: For each link its surfaces: colour, positions (n, 3) [m], triangles (m, 3).
        step: Width of the grid [m].

    Returns:
        The packed surfaces.
    """
    codes, names = bytearray(), bytearray()
    residuals: list[Array] = []
    table: list[dict[str, Any]] = []
    for number, link in enumerate(links):
        for rgba, vertices, triangles in link:
            positions, faces = _on_grid(vertices, triangles, step)
            if not len(faces):
                continue
            path = walk(faces)
            codes += bytes(path.codes)
            names += _varints(path.names)
            residuals.append(_residuals(positions[path.order], np.array(path.predictors)))
            table.append(
                {
                    "link": number,
                    "color": [round(c, 3) for c in rgba],
                    "triangles": len(faces),
                    "vertices": len(path.order),
                }
            )
    flat = np.concatenate(residuals or [np.zeros((0, 3), dtype=np.int64)]).T.reshape(-1)
    zigzag = np.where(flat < 0, -2 * flat - 1, 2 * flat).astype(np.uint32)
    low, high = (zigzag & 255).astype(np.uint8).tobytes(), (zigzag >> 8).astype("<u2").tobytes()
    streams = (bytes(codes), bytes(names), low, high)
    data = zlib.compress(b"".join(streams), 9)
    return PackedMeshes(data, tuple(table), tuple(len(s) for s in streams), step)


def _merged(surface: Surface) -> tuple[RGBA, Floats, Array]:
    positions, index = merged_vertices(surface.vertices)
    return surface.rgba, positions, index[surface.triangles]


def _simplified(vertices: Floats, triangles: Array, bounds: Sequence[float]) -> tuple[Floats, Array]:
    size = float(np.ptp(vertices, axis=0).max(initial=0.0)) if len(vertices) else 0.0
    for bound in bounds:
        vertices, triangles = decimated(vertices, triangles, min(bound, _RELATIVE_BOUND * size))
        used, inverse = np.unique(triangles, return_inverse=True)
        vertices, triangles = vertices[used], inverse.reshape(-1, 3)
    return vertices, triangles


def _on_grid(vertices: Floats, triangles: Array, step: float) -> tuple[Array, Array]:
    """Positions in steps, each once, and the triangles that still have three of them."""
    grid = np.round(np.asarray(vertices) / step).astype(np.int64)
    positions, index = np.unique(grid, axis=0, return_inverse=True)
    faces = index.reshape(-1)[triangles]
    a, b, c = faces.T
    return positions, faces[(a != b) & (b != c) & (c != a)]


def _residuals(positions: Array, predictors: Array) -> Array:
    """How far vertices (n, 3), in the order of the walk, are from their predictions."""
    first = np.concatenate([positions, np.zeros((1, 3), dtype=np.int64)])  # -1 is the origin
    u, v, x = predictors.T
    return positions - (first[u] + first[v] - first[x])


def _varints(values: Iterable[int]) -> bytes:
    """Numbers from 0 in groups of seven bits, the lowest first (LEB128)."""
    out = bytearray()
    for value in values:
        rest = value
        while rest > 127:
            out.append(rest & 127 | 128)
            rest >>= 7
        out.append(rest)
    return bytes(out)
