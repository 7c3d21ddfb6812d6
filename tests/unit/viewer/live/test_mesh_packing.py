"""Packed meshes: what a reader of the format gets back is what was packed, to half a step of the grid."""

from __future__ import annotations

import zlib

import numpy as np
import pytest

from ulna.viewer.live.mesh_packing import PackedMeshes, pack, packed_within
from ulna.viewer.live.triangle_codes import ANOTHER, BORDER, NEW, NEXT, PREVIOUS
from ulna.viewer.mesh.surface import Surface

WHITE = (1.0, 1.0, 1.0, 1.0)


class Reader:
    """A second reader of the format, after its description, with other data structures than the page's."""

    def __init__(self, packed: PackedMeshes) -> None:
        raw, at = zlib.decompress(packed.data), 0
        parts = []
        for length in packed.streams:
            parts.append(raw[at : at + length])
            at += length
        assert at == len(raw)
        self.codes, self.names = iter(parts[0]), iter(parts[1])
        low, high = np.frombuffer(parts[2], np.uint8), np.frombuffer(parts[3], "<u2")
        zigzag = low.astype(np.int64) | high.astype(np.int64) << 8
        numbers = np.where(zigzag % 2, -(zigzag + 1) // 2, zigzag // 2)
        self.residuals = iter(numbers.reshape(3, -1).T)
        self.packed = packed

    def surfaces(self) -> list[tuple[np.ndarray, np.ndarray]]:
        out = [self.surface(s["triangles"], s["vertices"]) for s in self.packed.surfaces]
        assert next(self.codes, None) is None and next(self.names, None) is None
        assert next(self.residuals, None) is None
        return out

    def surface(self, count: int, vertices: int) -> tuple[np.ndarray, np.ndarray]:
        self.points: list[np.ndarray] = []
        triangles: list[tuple[int, int, int]] = []
        after: dict[int, int] = {}
        before: dict[int, int] = {}
        third: dict[int, int] = {}
        stack: list[tuple[int, int]] = []

        def opened(u: int, v: int, w: int) -> None:
            after[u], before[v], third[u] = v, u, w
            stack.append((u, v))

        def closed(u: int, v: int) -> None:
            del after[u]
            if before.get(v) == u:
                del before[v]

        while len(triangles) < count:
            u, v, w = (self.named(len(self.points) - 1) for _ in range(3))
            triangles.append((u, v, w))
            for edge in ((v, u, w), (w, v, u), (u, w, v)):
                opened(*edge)
            while stack:
                a, b = stack.pop()
                if after.get(a) != b:
                    continue
                opposite = third[a]
                closed(a, b)
                code = next(self.codes)
                if code == BORDER:
                    continue
                c = {NEW: -1, NEXT: after.get(b), PREVIOUS: before.get(a), ANOTHER: -2}[code]
                if code == NEW:
                    c = self.met(self.points[a] + self.points[b] - self.points[opposite])
                elif code == ANOTHER:
                    c = self.named(-1)
                assert c is not None
                triangles.append((a, b, c))
                for x, y, z in ((c, a, b), (b, c, a)):
                    if after.get(x) == y:
                        closed(x, y)
                    else:
                        opened(y, x, z)
        assert len(self.points) == vertices
        return np.array(self.points) * self.packed.step, np.array(triangles)

    def met(self, prediction: np.ndarray) -> int:
        self.points.append(prediction + next(self.residuals))
        return len(self.points) - 1

    def named(self, predictor: int) -> int:
        number, shift = 0, 0
        while True:
            byte = next(self.names)
            number |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        if number:
            return len(self.points) - number
        return self.met(self.points[predictor] if predictor >= 0 else np.zeros(3, dtype=np.int64))


def corners(vertices: np.ndarray, triangles: np.ndarray) -> list[tuple[tuple[float, ...], ...]]:
    """The triangles by their places, each begun at its least corner, so that orientation counts."""
    out = []
    for triangle in triangles:
        places = [tuple(vertices[k]) for k in triangle]
        first = places.index(min(places))
        out.append(tuple(places[first:] + places[:first]))
    return sorted(out)


def grid(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A bumpy open sheet of 2 n^2 triangles."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0))
    z = np.random.default_rng(seed).integers(-3, 4, x.shape)
    k = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (part.reshape(-1) for part in (k[:-1, :-1], k[:-1, 1:], k[1:, 1:], k[1:, :-1]))
    return np.stack([x, y, z], -1).reshape(-1, 3), np.concatenate(
        [np.stack([a, b, c], 1), np.stack([a, c, d], 1)]
    )


def soup(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Triangles between few points in any way: edges of three triangles and more, of either orientation."""
    rng = np.random.default_rng(seed)
    points = rng.permutation(1000)[:36].reshape(12, 3).astype(float)
    triangles = np.array([rng.permutation(12)[:3] for _ in range(60)])
    return points, triangles


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [
        grid(1, 0),
        grid(9, 1),
        *(soup(seed) for seed in range(20)),
        (np.zeros((0, 3)), np.zeros((0, 3), dtype=int)),
    ],
)
def test_a_reader_gets_the_triangles_back(vertices: np.ndarray, triangles: np.ndarray) -> None:
    packed = pack([[(WHITE, vertices, triangles)], []], step=1.0)
    read = Reader(packed).surfaces()
    assert packed.triangles == len(triangles)
    got = [corners(*surface) for surface in read] or [[]]
    assert got == [corners(vertices, triangles)]


def test_several_surfaces_and_links_are_read_in_order() -> None:
    red = (1.0, 0.0, 0.0, 0.5)
    shapes = [grid(3, 2), soup(3), grid(2, 4)]
    packed = pack([[(WHITE, *shapes[0]), (red, *shapes[1])], [(WHITE, *shapes[2])]], step=1.0)
    assert [s["link"] for s in packed.surfaces] == [0, 0, 1]
    assert packed.surfaces[1]["color"] == list(red)
    for (vertices, triangles), (given, faces) in zip(Reader(packed).surfaces(), shapes, strict=True):
        assert corners(vertices, triangles) == corners(given, faces)


def test_positions_are_rounded_to_half_a_step_at_most() -> None:
    vertices, triangles = grid(6, 5)
    moved = vertices + np.random.default_rng(0).uniform(-0.3, 0.3, vertices.shape)
    read, _ = Reader(pack([[(WHITE, moved, triangles)]], step=1e-3)).surfaces()[0]
    nearest = np.abs(moved[:, None] - read[None]).max(axis=2).min(axis=1)
    assert nearest.max() <= 0.5e-3 + 1e-12


def test_large_distances_take_the_high_bytes() -> None:
    vertices = np.array([[-1e6, 3e5, 0.0], [1e6, 0.0, 2.0], [0.0, -4e5, 1e6]])
    read, _ = Reader(pack([[(WHITE, vertices, np.array([[0, 1, 2]]))]], step=1.0)).surfaces()[0]
    assert corners(read, np.array([[0, 1, 2]])) == corners(vertices, np.array([[0, 1, 2]]))


def test_triangles_that_vanish_on_the_grid_are_left_out() -> None:
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.1, 0]])
    packed = pack([[(WHITE, vertices, np.array([[0, 1, 2], [0, 1, 3]]))]], step=1.0)
    assert packed.triangles == 1


def test_surfaces_are_simplified_no_more_than_needed() -> None:
    pytest.importorskip("fast_simplification")
    hull = pytest.importorskip("scipy.spatial").ConvexHull
    points = np.random.default_rng(3).normal(size=(2500, 3))
    points *= 0.2 / np.linalg.norm(points, axis=1, keepdims=True)
    faces = hull(points).simplices
    inward = (
        np.einsum(
            "ij,ij->i",
            np.cross(*(points[faces[:, k]] - points[faces[:, 0]] for k in (1, 2))),
            points[faces[:, 0]],
        )
        < 0
    )
    faces[inward] = faces[inward][:, ::-1]
    ball = Surface(points, faces, points / 0.2, WHITE)
    all_ = packed_within([[ball]], 1 << 30, 1e-5)
    fewer = packed_within([[ball]], 1, 1e-5)
    assert len(fewer.data) < len(all_.data) and fewer.triangles < all_.triangles
    for packed in (all_, fewer):
        vertices, triangles = Reader(packed).surfaces()[0]
        assert np.abs(np.linalg.norm(vertices, axis=1) - 0.2).max() < 4e-3
        edges = {tuple(t[[k, (k + 1) % 3]]) for t in triangles for k in range(3)}
        assert all((b, a) in edges for a, b in edges), "the ball has a hole"
